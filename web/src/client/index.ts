// What the browser viewer and Node programs share: HTTP calls, the stream, decoding. No DOM in here.
export * from "./decode";
export * from "./locate";
export * from "./problem";
export * from "./rest";
export * from "./stream";
export * from "./studies";
export * from "./unpack";
export * from "./watch";
export * as messages from "./gen/truestep/v1/stream_pb";
export { create, fromBinary, toBinary } from "@bufbuild/protobuf";
