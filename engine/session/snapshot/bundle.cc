#include "engine/session/snapshot/bundle.h"

#include "engine/base/errors.h"
#include "engine/base/version.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/commands.h"
#include "engine/session/snapshot/snapshot.h"

namespace truestep {

namespace json = boost::json;

namespace {

std::string journal_text(std::span<const JournalEntry> journal) {
  json::array list;
  for (const JournalEntry& e : journal)
    list.push_back(json::object{{"step", e.step}, {"command", write_command(e.command)}});
  return write_json(list);
}

std::vector<JournalEntry> read_journal(const SealedReader& in, const json::value& document) {
  std::vector<JournalEntry> out;
  if (!document.is_array()) in.fail("its journal is not a list");
  for (const json::value& v : document.as_array()) {
    const json::value* step = v.is_object() ? v.as_object().if_contains("step") : nullptr;
    const json::value* command = v.is_object() ? v.as_object().if_contains("command") : nullptr;
    json::error_code ec;
    const auto number = step ? step->to_number<uint64_t>(ec) : 0;
    if (!step || !command || ec) in.fail("an entry of its journal is malformed");
    if (number > kMostStep || (!out.empty() && number < out.back().step))
      in.fail("its journal is out of order");
    out.push_back({number, out.size() + 1, read_command(*command)});
  }
  return out;
}

}  // namespace

Bundle bundle_of(const Session& session) {
  const World& world = session.world();
  Bundle b;
  b.scene = world.scene().canonical();
  b.build = std::string(version()) + " " + std::string(build_description());
  if (session.origin()) b.start = write_snapshot(world, *session.origin());
  const auto done = session.journal_done();
  b.journal.assign(done.begin(), done.end());
  b.end = {session.step_index(), session.hash()};
  for (const WorldState* s : session.snapshots()) {
    if (s->step <= b.end.step) b.checkpoints.push_back({s->step, s->hash()});
  }
  return b;
}

Bytes write_bundle(const Bundle& b) {
  SealedWriter out;
  out.text(write_json(b.scene));
  out.text(b.build);
  out.block(b.start);
  out.text(journal_text(b.journal));
  out.number(b.checkpoints.size());
  for (const Checkpoint& c : b.checkpoints) out.number(c.step), out.number(c.hash);
  out.number(b.end.step), out.number(b.end.hash);
  return seal(kBundleFile, out.contents());
}

Bundle read_bundle(std::span<const std::byte> file) {
  SealedReader in(kBundleFile, unseal(kBundleFile, file));
  Bundle b;
  b.scene = parse_json(in.text());
  b.build = in.text();
  const auto start = in.block();
  b.start.assign(start.begin(), start.end());
  b.journal = read_journal(in, parse_json(in.text()));
  for (uint64_t n = in.number(); n > 0; --n) {
    const uint64_t step = in.number(), hash = in.number();
    if (!b.checkpoints.empty() && step <= b.checkpoints.back().step) in.fail("its steps are out of order");
    b.checkpoints.push_back({step, hash});
  }
  b.end.step = in.number(), b.end.hash = in.number();
  const bool past = (!b.journal.empty() && b.journal.back().step > b.end.step) ||
                    (!b.checkpoints.empty() && b.checkpoints.back().step > b.end.step);
  if (!in.done() || past || b.end.step > kMostStep) in.fail("its end is malformed");
  return b;
}

ReplayResult replay(const Bundle& b, std::shared_ptr<const ThreadArena> arena,
                    const std::function<void(uint64_t step)>& progress) {
  const auto world = std::make_shared<const World>(require_scene(read_scene(b.scene)));
  Session session(world, std::move(arena), {.history_bytes = 0});
  if (!b.start.empty()) session.restore(read_snapshot(*world, b.start));
  ReplayResult result;
  result.first_step = session.step_index();
  uint64_t same = result.first_step;
  const auto behind = [](const char* what) {
    throw Error("bad_bundle", std::string("the bundle cannot be used: ") + what + " before its start");
  };
  const auto go_to = [&](uint64_t step) {
    while (session.step_index() < step) {
      if (session.step(1) == 0) throw Error("instability", session.failure()->detail);
      if (progress) progress(session.step_index());
    }
  };
  const auto compare = [&](const Checkpoint& c) {
    if (c.step < session.step_index()) behind("a checkpoint lies");
    go_to(c.step);
    result.last_step = c.step, result.hash = session.hash();
    if (result.hash != c.hash) result.difference = {same, c.step, c.hash, result.hash};
    same = c.step;
    return !result.difference;
  };
  auto checkpoint = b.checkpoints.begin();
  for (const JournalEntry& e : b.journal) {
    for (; checkpoint != b.checkpoints.end() && checkpoint->step <= e.step; ++checkpoint) {
      if (!compare(*checkpoint)) return result;
    }
    if (e.step < session.step_index()) behind("a command lies");
    go_to(e.step);
    session.command(e.command);
  }
  for (; checkpoint != b.checkpoints.end(); ++checkpoint) {
    if (!compare(*checkpoint)) return result;
  }
  compare(b.end);
  return result;
}

}  // namespace truestep
