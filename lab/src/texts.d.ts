// Made by the build of `table.ts`: its texts as JSON, deflated, in base64.

declare module "lab-texts" {
  const packed: string;
  export default packed;
}
