"""The viewer in marimo: settings of the page in Python, and the other way round.

pip install "basrelief[notebook]" marimo
marimo edit examples/viewer.py
"""

import marimo

app = marimo.App(width="medium")


@app.cell
def _():
    import marimo as mo

    import basrelief
    from basrelief.viewer import Viewer

    return Viewer, basrelief, mo


@app.cell
def _(Viewer, basrelief):
    bricks = basrelief.sample("bricks", 256)
    widget = Viewer(bricks, scale=0.08, camera=basrelief.Orbit(24, 32))
    return (widget,)


@app.cell
def _(mo, widget):
    # cells that use `viewer` run anew with every change in the page, those of `widget` do not
    viewer = mo.ui.anywidget(widget)
    viewer
    return (viewer,)


@app.cell
def _(mo, viewer):
    angles = f"azimuth {viewer.camera.azimuth:g}, elevation {viewer.camera.elevation:g}"
    mo.md(f"In Python: {viewer.technique}, scale {viewer.scale:g}, {angles}")
    return


@app.cell
def _(basrelief, viewer):
    basrelief.render(viewer.scene(), size=(480, 270))
    return


@app.cell
def _(basrelief, mo):
    technique = mo.ui.dropdown(
        [*basrelief.TECHNIQUES], value="relief", label="The technique, from Python:"
    )
    technique
    return (technique,)


@app.cell
def _(technique, widget):
    widget.technique = technique.value
    return


if __name__ == "__main__":
    app.run()
