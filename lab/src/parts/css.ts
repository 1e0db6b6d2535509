// Styles of single elements. Set as a property (`.style=${css(…)}`): the policy forbids the attribute.

export const css = (fields: Record<string, string>) =>
  Object.entries(fields)
    .map(([name, value]) => `${name}: ${value}`)
    .join("; ");
