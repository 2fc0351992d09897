// Words for people.

export const words = (name) => name.replaceAll("_", " ");
export const firstLine = (error) => String(error?.message ?? error).split("\n")[0];
