#include "engine/session/snapshot/sealed.h"

#include <cstring>

#include "engine/base/errors.h"
#include "engine/base/hash.h"

namespace truestep {

namespace {

constexpr size_t kName = 8, kHead = kName + 4 + 4 + 8, kSum = 8;

template <class T>
void put(Bytes& out, const T& v) {
  const auto* b = reinterpret_cast<const std::byte*>(&v);
  out.insert(out.end(), b, b + sizeof v);
}

template <class T>
T get(std::span<const std::byte> bytes, size_t at) {
  T v;
  std::memcpy(&v, bytes.data() + at, sizeof v);
  return v;
}

uint64_t checksum(std::span<const std::byte> bytes) {
  Hasher h;
  h.bytes(bytes.data(), bytes.size());
  return h.value();
}

}  // namespace

Bytes seal(const SealKind& kind, std::span<const std::byte> contents) {
  Bytes out;
  out.reserve(kHead + contents.size() + kSum);
  const auto name = std::as_bytes(std::span(kind.name.data(), kName));
  out.insert(out.end(), name.begin(), name.end());
  put(out, kind.version);
  put(out, uint32_t{0});
  put(out, uint64_t{contents.size()});
  out.insert(out.end(), contents.begin(), contents.end());
  put(out, checksum(out));
  return out;
}

std::span<const std::byte> unseal(const SealKind& kind, std::span<const std::byte> file) {
  const SealedReader reader(kind, file);
  if (file.size() < kHead + kSum || std::memcmp(file.data(), kind.name.data(), kName) != 0)
    reader.fail("the bytes are not of this format");
  const auto version = get<uint32_t>(file, kName);
  if (version > kind.version)
    reader.fail("its version is " + std::to_string(version) + ", this build reads up to " +
                std::to_string(kind.version));
  const auto size = get<uint64_t>(file, kName + 8);
  if (version == 0 || get<uint32_t>(file, kName + 4) != 0 || size != file.size() - kHead - kSum)
    reader.fail("its length is wrong: it is incomplete or too long");
  if (get<uint64_t>(file, kHead + size) != checksum(file.first(kHead + size)))
    reader.fail("it is damaged: the checksum does not match");
  return file.subspan(kHead, size);
}

void SealedReader::fail(const std::string& why) const {
  throw Error(kind_.error, "the " + std::string(kind_.what) + " cannot be used: " + why);
}

std::span<const std::byte> SealedReader::take(uint64_t size) {
  if (size > rest_.size()) fail("it ends too early");
  const auto part = rest_.first(size);
  rest_ = rest_.subspan(size);
  return part;
}

uint64_t SealedReader::number() {
  return get<uint64_t>(take(8), 0);
}

std::span<const std::byte> SealedReader::block() {
  return take(number());
}

std::string SealedReader::text() {
  const auto bytes = block();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void SealedWriter::number(uint64_t v) {
  put(out_, v);
}

void SealedWriter::block(std::span<const std::byte> bytes) {
  number(bytes.size());
  out_.insert(out_.end(), bytes.begin(), bytes.end());
}

}  // namespace truestep
