// How long a request takes there and back, measured while the page is seen.
import type { Service } from "./rest";

const kEvery = 2000; // ms

export function measureTrips(service: Service, wanted: () => boolean, took: (ms: number) => void): void {
  const measure = async (): Promise<void> => {
    if (document.hidden || !wanted()) return;
    await service.roundTrip().then(took, () => undefined);
  };
  setInterval(() => void measure(), kEvery);
  void measure();
}
