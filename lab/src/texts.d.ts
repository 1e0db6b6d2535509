// Made by the build of `table.ts`: its keys and columns as lists in JSON, deflated, in base64.

declare module "lab-texts" {
  const packed: string;
  export default packed;
}
