// Texts of the engine in Romanian, French and Portuguese.

export const ENGINE = {} as const satisfies Record<string, readonly [string, string, string]>;
