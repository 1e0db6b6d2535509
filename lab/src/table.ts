export const TABLE: Record<string, readonly [string, string, string]> = {};
