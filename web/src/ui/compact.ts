// The encoding of a session's frames: floats while they are small, 16-bit differences when there are many points, and
// floats again if a quantum would be visible (one distant point makes the box large).
import { meaning } from "../client/parts";
import type { DecodedFrame } from "../client/decode";
import { Encoding, type Hello, type Topology } from "../client/gen/truestep/v1/stream_pb";

const kMany = 20000; // rows of a frame's positions
const kSeen = 0.1; // of a point's radius, visible size of a quantum

export class Compact {
  private able = false;
  private radius = new Map<string, number>();
  private position = new Map<string, string | undefined>();
  private encoding = Encoding.F32;

  greet(hello: Hello): void {
    this.able = hello.capabilities.includes("Q16_DELTA");
    this.encoding = Encoding.F32;
    this.position = new Map(hello.parts.map((part) => [part.id, meaning(part, "position")]));
  }

  connect(topology: Topology): void {
    this.radius = new Map(topology.systems.map((system) => [system.system, system.pointRadius]));
  }

  /** The encoding for the frames after this one. */
  choose(frame: DecodedFrame): Encoding {
    const positions = frame.fields.filter((field) => field.field === this.position.get(field.system));
    if (positions.some((field) => field.quantum > kSeen * (this.radius.get(field.system) ?? 0))) {
      this.able = false;
      this.encoding = Encoding.F32;
    } else if (this.able && positions.reduce((sum, field) => sum + field.count, 0) >= kMany) {
      this.encoding = Encoding.Q16_DELTA;
    }
    return this.encoding;
  }
}
