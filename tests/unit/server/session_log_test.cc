#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <future>
#include <random>

#include "engine/base/errors.h"
#include "engine/session/snapshot/snapshot.h"
#include "server/persistence/files.h"
#include "server/persistence/sessions/saved_session.h"
#include "server/persistence/sessions/session_keeper.h"

namespace truestep {
namespace {

namespace fs = std::filesystem;
using Kind = LogRecord::Kind;
using End = LogContents::End;

class SessionLog : public ::testing::Test {
 protected:
  ~SessionLog() override { fs::remove_all(path); }
  const fs::path path =
      fs::temp_directory_path() / ("truestep-log-" + std::to_string(std::random_device()()));
  const Place folder = [this] {
    fs::create_directories(path);
    return Place::folder(path.string());
  }();
};

const std::vector<LogRecord> kRecords = {{Kind::continues, 0, 0, ""},
                                         {Kind::stands, 7, 0, ""},
                                         {Kind::command, 7, 1, R"({"type":"pin","system":"rope","index":3})"},
                                         {Kind::refused, 7, 1, ""},
                                         {Kind::command, 9, 2, std::string(500, 'x')}};

Bytes all_bytes(std::span<const LogRecord> records) {
  Bytes out;
  for (const LogRecord& r : records) {
    const Bytes one = record_bytes(r);
    out.insert(out.end(), one.begin(), one.end());
  }
  return out;
}

TEST_F(SessionLog, WhatIsAppendedIsRead) {
  OpenFiles files;
  RecordLog log(folder / "log", files);
  for (const LogRecord& r : kRecords) log.append(r);
  const LogContents read = read_records(read_file(folder / "log", 1 << 20));
  EXPECT_EQ(read.records, kRecords);
  EXPECT_EQ(read.end, End::clean);
  EXPECT_EQ(log.bytes() % 32, 0u);
}

TEST_F(SessionLog, TheSumOfARecordIsTheCrc32OfZip) {
  const Bytes bytes = record_bytes({Kind::stands, 7, 0, ""});
  uint32_t sum;
  std::memcpy(&sum, bytes.data() + 4, sizeof sum);
  EXPECT_EQ(sum, 0x027f28fbu) << "zlib.crc32(struct.pack('<IQQQ', 24, 4, 7, 0)) of Python";
}

TEST_F(SessionLog, WhereASessionStandsTakesNoMoreRoomTheSecondTime) {
  OpenFiles files;
  RecordLog log(folder / "log", files);
  log.append(kRecords[0]);
  for (uint64_t step = 1; step < 1000; ++step) log.append({Kind::stands, step, 0, ""});
  EXPECT_EQ(log.bytes(), 64u);
  log.append(kRecords[2]);
  log.append({Kind::stands, 3, 0, ""});
  const auto read = read_records(read_file(folder / "log", 1 << 20)).records;
  ASSERT_EQ(read.size(), 4u);
  EXPECT_EQ(read[1].step, 999u);
  EXPECT_EQ(read[3].step, 3u);
}

// Cut at every byte: the longest prefix of whole records, and never more.
TEST_F(SessionLog, AnyTornTailLeavesTheRecordsBefore) {
  const Bytes bytes = all_bytes(kRecords);
  size_t whole = 0, end = record_bytes(kRecords[0]).size();
  for (size_t size = 0; size < bytes.size(); ++size) {
    if (size == end) end += record_bytes(kRecords[++whole]).size();
    const LogContents read = read_records(std::span(bytes).first(size));
    ASSERT_EQ(read.records.size(), whole) << size;
    const bool clean = size == end - record_bytes(kRecords[whole]).size();
    ASSERT_EQ(read.end, clean ? End::clean : End::torn) << size;
  }
}

TEST_F(SessionLog, AFlippedBitIsFoundAndToldFromATornTail) {
  const Bytes bytes = all_bytes(kRecords);
  const size_t last = bytes.size() - record_bytes(kRecords.back()).size();
  for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    Bytes wrong = bytes;
    wrong[bit / 8] ^= std::byte(1 << bit % 8);
    const LogContents read = read_records(wrong);
    ASSERT_LT(read.records.size(), kRecords.size()) << bit;
    ASSERT_TRUE(std::equal(read.records.begin(), read.records.end(), kRecords.begin())) << bit;
    ASSERT_EQ(read.end, bit / 8 < last ? End::damaged : End::torn) << bit;
  }
}

TEST_F(SessionLog, FilesThatAreClosedForOthersGoOnWhereTheyWere) {
  OpenFiles files(2);
  std::vector<std::unique_ptr<RecordLog>> logs;
  for (int k = 0; k < 5; ++k) logs.push_back(std::make_unique<RecordLog>(folder / std::to_string(k), files));
  for (uint64_t round = 0; round < 3; ++round) {
    for (auto& log : logs) log->append({Kind::refused, round, 0, ""});
  }
  for (int k = 0; k < 5; ++k)
    EXPECT_EQ(read_records(read_file(folder / std::to_string(k), 1 << 20)).records.size(), 3u);
}

// --- what the records come to

JournalEntry pin(uint64_t step, uint64_t sequence) {
  Command c;
  c.kind = CommandKind::pin;
  c.system = "rope";
  c.index = static_cast<long long>(sequence);
  return {step, sequence, c};
}
LogRecord record(const JournalEntry& e) {
  return {Kind::command, e.step, e.sequence, command_text(e.command)};
}
std::vector<uint64_t> sequences(const LoggedCourse& c) {
  std::vector<uint64_t> out;
  for (const JournalEntry& e : c.journal) out.push_back(e.sequence);
  return out;
}

TEST(LoggedCourse, CommandsTakeBackTheFutureBehindThem) {
  const std::vector<LogRecord> records = {
      record(pin(5, 1)), record(pin(8, 2)), {Kind::stands, 20, 0, ""}, {Kind::stands, 6, 0, ""}};
  const LoggedCourse back = follow({}, 0, records);
  EXPECT_EQ(sequences(back), (std::vector<uint64_t>{1, 2}));
  EXPECT_EQ(back.step, 6u);
  std::vector<LogRecord> more = records;
  more.push_back(record(pin(6, 3)));
  more.push_back({Kind::stands, 7, 0, ""});
  EXPECT_EQ(sequences(follow({}, 0, more)), (std::vector<uint64_t>{1, 3}));
}

TEST(LoggedCourse, TheLastCommandMayNotHaveBeenCarriedOut) {
  std::vector<LogRecord> records = {record(pin(5, 1)), record(pin(5, 2))};
  EXPECT_EQ(follow({}, 0, records).unconfirmed->sequence, 2u);
  EXPECT_EQ(sequences(follow({}, 0, records)), std::vector<uint64_t>{1});
  records.push_back({Kind::refused, 5, 2, ""});
  EXPECT_FALSE(follow({}, 0, records).unconfirmed);
  EXPECT_EQ(sequences(follow({}, 0, records)), std::vector<uint64_t>{1});
}

TEST(LoggedCourse, RecordsThatContradictEachOtherAreRefused) {
  const std::vector<LogRecord> wrong[] = {{{Kind::stands, 3, 0, ""}},
                                          {{Kind::refused, 5, 9, ""}},
                                          {{Kind::stands, kMostStep + 1, 0, ""}},
                                          {{Kind::command, 5, 1, "{}"}}};
  for (const auto& records : wrong) {
    try {
      follow({}, 4, records);
      FAIL();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), "session_damaged");
    }
  }
}

// --- a keeper and what its folder comes to

class KeptSession : public SessionLog {
 protected:
  KeptSession() { start(); }
  void start() { session = std::make_unique<Session>(world(), std::make_shared<const ThreadArena>(1)); }
  static std::shared_ptr<const World> world() {
    return std::make_shared<const World>(parse_scene(
        R"({"systems": [{"type": "mass_spring", "id": "rope", "rope": {"from": [0, 1, 0], "to": [1, 1, 0], "links": 5}}]})"));
  }
  std::shared_ptr<SessionKeeper> keep() {
    auto keeper =
        std::make_shared<SessionKeeper>(SessionFolder(folder / kId), *session, SessionKeeper::Beginning{},
                                        KeepingMeans{files, writer, memory});
    session->add_sink(keeper);
    return keeper;
  }
  SavedSession saved() {
    // Everything handed to the writing thread has been written.
    std::promise<void> done;
    writer.post([&] { done.set_value(); });
    done.get_future().wait();
    return read_saved_session(SessionFolder(folder / kId), std::nullopt);
  }
  // The hash of the state restored from disk.
  uint64_t restored_hash() {
    const SavedSession s = saved();
    Session other(world(), std::make_shared<const ThreadArena>(1));
    std::optional<WorldState> origin;
    if (!s.snapshot.empty()) origin = read_snapshot(other.world(), s.snapshot);
    other.resume(std::move(origin), s.course.journal);
    other.step(s.course.step - s.from_step);
    other.carry_out_due_commands();
    if (s.course.unconfirmed) other.command(s.course.unconfirmed->command);
    return other.hash();
  }

  const std::string kId = "00000000-0000-4000-8000-000000000000";
  OpenFiles files;
  StateWriter writer;
  MemoryBudget memory{1e9};
  std::unique_ptr<Session> session;
};

TEST_F(KeptSession, AnyCourseLeadsToTheSameHash) {
  SessionFolder::create(folder, {kId, "", "", 1, 2}, session->world().scene().canonical(), {});
  std::mt19937 random(5);
  auto keeper = keep();
  for (int k = 0; k < 300; ++k) {
    switch (random() % 8) {
      case 0:
        session->command(pin(0, random() % 5).command);
        break;
      case 1:
        session->seek(session->first_step() + random() % 40);
        break;
      case 2:
        keeper->save_anew();
        break;
      case 3:
        keeper->worked(10);
        break;
      case 4:
        if (random() % 10 == 0) session->reset();
        break;
      case 5:
        keeper->save();
        break;
      default:
        session->step(random() % 7);
        keeper->stands();
    }
    keeper->stands();
    ASSERT_EQ(restored_hash(), session->hash()) << k;
  }
}

TEST_F(KeptSession, ACommandThatIsLeftOutShows) {  // control
  SessionFolder::create(folder, {kId, "", "", 1, 2}, session->world().scene().canonical(), {});
  auto keeper = keep();
  session->step(5);
  session->command(pin(0, 2).command);
  session->step(5);
  keeper->stands();
  Session other(world(), std::make_shared<const ThreadArena>(1));
  other.resume(std::nullopt, {});
  other.step(saved().course.step);
  EXPECT_NE(other.hash(), session->hash());
  EXPECT_EQ(restored_hash(), session->hash());
}

TEST_F(KeptSession, AStateThatIsDamagedLeavesTheOneBefore) {
  const auto sf =
      SessionFolder::create(folder, {kId, "", "", 1, 2}, session->world().scene().canonical(), {});
  auto keeper = keep();
  session->step(5);
  session->command(pin(0, 2).command);
  session->step(5);
  keeper->worked(0.5);
  keeper->save();
  session->step(5);
  keeper->stands();
  const auto states = sf.contents().states;
  ASSERT_FALSE(states.empty());
  ASSERT_EQ(restored_hash(), session->hash());
  EXPECT_EQ(saved().from_step, 10u);
  for (const auto& [number, step] : states) std::ofstream(sf.state_place(number, step).path()) << "nonsense";
  ASSERT_EQ(restored_hash(), session->hash());
  EXPECT_EQ(saved().from_step, 0u);
  EXPECT_TRUE(saved().complete);
}

TEST_F(KeptSession, ASavedStateIsReadAsItWasWrittenOrNotAtAll) {
  SavedState state{write_snapshot(session->world(), session->state()), {pin(3, 4), pin(3, 5)}, 9};
  const Bytes bytes = write_saved_state(state);
  const SavedState read = read_saved_state(bytes);
  EXPECT_EQ(read.snapshot, state.snapshot);
  EXPECT_EQ(read.ahead.size(), 2u);
  EXPECT_EQ(read.ahead[1].sequence, 5u);
  EXPECT_EQ(read.last_sequence, 9u);
  for (size_t k = 0; k < bytes.size(); k += 3) {
    Bytes wrong = bytes;
    wrong[k] ^= std::byte{4};
    EXPECT_THROW(read_saved_state(wrong), Error) << k;
  }
}

}  // namespace
}  // namespace truestep
