// The parts of the page of studies that need no page: what the tests in Node run.
export * from "./accuracy";
export * from "./axis";
export * from "./form_model";
export * from "./model";
export * from "./numbers";
export { sorted } from "./table";
export * from "./words";
