// The state of a world as bytes, and the checks that a state belongs to a world.
#include <bit>
#include <cmath>
#include <cstring>

#include "engine/base/errors.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/world/world.h"

namespace truestep {

uint64_t WorldState::hash() const {
  Hasher h;
  h.integer(step);
  h.integer(systems.size());
  for (const State& s : systems) s.hash(h);
  for (const State& s : couplings) s.hash(h);
  for (const WorldState& s : finer) h.integer(s.hash());
  return h.value();
}

std::vector<std::byte> WorldState::serialize() const {
  std::vector<std::byte> out;
  const auto put = [&](const void* p, size_t n) {
    if (n == 0) return;
    const size_t end = out.size();
    out.resize(end + n);
    std::memcpy(out.data() + end, p, n);
  };
  // Systems in the lower half of the count, couplings in the upper half, whose last bits flag that the energy
  // watch and a companion follow.
  const uint64_t count = systems.size() | uint64_t{couplings.size()} << 32 | uint64_t{!watch.empty()} << 62 |
                         uint64_t{!finer.empty()} << 63;
  put(&step, 8);
  put(&count, 8);
  for (const auto* states : {&systems, &couplings}) {
    for (const State& s : *states) {
      const auto bytes = s.serialize();
      const uint64_t size = bytes.size();
      put(&size, 8);
      put(bytes.data(), bytes.size());
    }
  }
  for (const EnergyWatch& w : watch) {
    const auto phase = static_cast<uint64_t>(w.phase);
    put(&w.reference, 8);
    put(&w.available, 8);
    put(&phase, 8);
  }
  for (const WorldState& s : finer) {
    const auto bytes = s.serialize();
    const uint64_t size = bytes.size();
    put(&size, 8);
    put(bytes.data(), bytes.size());
  }
  return out;
}

WorldState WorldState::deserialize(std::span<const std::byte> bytes) {
  return read(bytes, Companion::allowed);
}

WorldState WorldState::read(std::span<const std::byte> bytes, Companion companion) {
  const auto get = [&]() {
    uint64_t v;
    if (bytes.size() < 8) throw Error("bad_snapshot", "the snapshot ends too early");
    std::memcpy(&v, bytes.data(), 8);
    bytes = bytes.subspan(8);
    return v;
  };
  WorldState state;
  state.step = get();
  const uint64_t count = get(), systems = count & 0xffffffff, couplings = count >> 32 & 0x3fffffff;
  if (systems > 256 || couplings > 256) {
    throw Error("bad_snapshot", "the snapshot names too many systems or couplings");
  }
  for (uint64_t i = 0; i < systems + couplings; ++i) {
    const uint64_t size = get();
    if (size > bytes.size()) throw Error("bad_snapshot", "the snapshot ends too early");
    (i < systems ? state.systems : state.couplings).push_back(State::deserialize(bytes.first(size)));
    bytes = bytes.subspan(size);
  }
  for (uint64_t i = 0; (count >> 62 & 1) && i < systems; ++i) {
    EnergyWatch& w = state.watch.emplace_back();
    w.reference = std::bit_cast<double>(get());
    w.available = std::bit_cast<double>(get());
    w.phase = static_cast<EnergyWatch::Phase>(std::min<uint64_t>(get(), 2));
  }
  if (count >> 63) {
    const uint64_t size = get();
    if (size > bytes.size()) throw Error("bad_snapshot", "the snapshot ends too early");
    if (companion == Companion::none)
      throw Error("bad_snapshot", "a companion state must not contain another one");
    state.finer.push_back(read(bytes.first(size), Companion::none));
    bytes = bytes.subspan(size);
  }
  if (!bytes.empty()) throw Error("bad_snapshot", "unexpected bytes follow the end of the snapshot");
  return state;
}

size_t WorldState::memory_bytes() const {
  size_t n = 0;
  for (const State& s : systems) n += s.memory_bytes();
  for (const State& s : couplings) n += s.memory_bytes();
  for (const WorldState& s : finer) n += s.memory_bytes();
  return n;
}

void World::require_finite_energy(const WorldState& state) const {
  std::vector<Issue> issues;
  for (size_t i = 0; i < size(); ++i) {
    const auto e = energy(state, i);
    if (!e || std::isfinite(e->kinetic + e->potential)) continue;
    issues.push_back({"/systems/" + std::to_string(scene_.systems[i].place), "out_of_range",
                      "the energy of the start is not finite", "", "values that give finite results", "",
                      "J"});
  }
  if (!issues.empty())
    throw Error("scene_invalid", "the energy of the scene's start is not finite", std::move(issues));
}

void World::require_state(const WorldState& state) const {
  const auto foreign = [] { return Error("bad_snapshot", "the snapshot belongs to another scene"); };
  const WorldState start = initial_state();
  if (state.systems.size() != start.systems.size() || state.couplings.size() != start.couplings.size() ||
      state.finer.size() != start.finer.size())
    throw foreign();
  if (state.step > kMostStep || (!state.watch.empty() && state.watch.size() != size()))
    throw Error("bad_snapshot", "the snapshot's clock or energy watch is malformed");
  const double t = static_cast<double>(state.step) * dt();
  for (size_t i = 0; i < size(); ++i) {
    StateCheck check(state.systems[i], start.systems[i]);
    systems_[i]->check(check, t);
    check.finish();
  }
  for (size_t i = 0; i < state.couplings.size(); ++i)
    StateCheck(state.couplings[i], start.couplings[i]).finish();
  for (const WorldState& s : state.finer) finer_->require_state(s);
}

uint64_t World::fingerprint() const {
  boost::json::object d = scene_.canonical();
  for (const char* key : {"$schema", "name", "title", "teaches", "tags", "observables", "probes", "recording",
                          "on_instability", "keep_running", "viewer", "expect"})
    d.erase(key);
  boost::json::object& time = d.at("time").as_object();
  for (const char* key : {"duration", "max_catchup_steps"}) time.erase(key);
  Hasher h;
  h.text(write_json(d));
  return h.value();
}

}  // namespace truestep
