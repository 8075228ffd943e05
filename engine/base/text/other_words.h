// Words that other programs, books and people use for what has another name here.
#pragma once
#include <span>
#include <string_view>

namespace truestep {

/// What the word may mean here, likeliest first; empty when it is not known.
std::span<const std::string_view> names_for(std::string_view word);

}  // namespace truestep
