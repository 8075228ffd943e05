// Traversal of constraints sorted by colour: constraints of one colour share no moving body and may be solved
// in parallel.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace truestep {

/// Contacts with static bodies tend to have the first colours: `back` solves them last.
enum class ColourOrder : uint8_t { forth, back };

/// body(item) for all items, those of a colour in parallel, in tasks of `block` items. `begin`: the first
/// item of every colour, and the end; empty: no items. `threads` has for_blocks(n, block, body(begin, end)).
template <class Threads, class Body>
void each_colour(std::span<const uint32_t> begin, ColourOrder order, const Threads& threads, size_t block,
                 Body&& body) {
  const size_t colours = begin.empty() ? 0 : begin.size() - 1;
  for (size_t k = 0; k < colours; ++k) {
    const size_t c = order == ColourOrder::forth ? k : colours - 1 - k;
    const uint32_t first = begin[c];
    threads.for_blocks(begin[c + 1] - first, block, [&](size_t from, size_t to) {
      for (size_t i = first + from; i < first + to; ++i) body(i);
    });
  }
}

}  // namespace truestep
