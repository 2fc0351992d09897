// Text for messages and labels.

/** @type {(name: string) => string} */
export const words = (name) => name.replaceAll("_", " ");
/** @type {(error: unknown) => string} */
export const firstLine = (error) => {
  const { message } = /** @type {{ message?: string }} */ (error ?? {});
  return String(message ?? error).split("\n")[0];
};
