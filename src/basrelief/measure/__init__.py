"""How wrong a technique is: the exact answer in float64, and errors against it."""
