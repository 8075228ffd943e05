// What nearly every file of the server includes, compiled once. Boost.Asio and Beast are not: only net knows
// them.
#pragma once
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <boost/json.hpp>
#include <charconv>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "engine/session/session.h"

#if defined(__x86_64__)
#include <immintrin.h>
#endif
