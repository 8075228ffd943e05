// Members of a request's JSON body, read strictly: every fault has its pointer.
#pragma once
#include <boost/json.hpp>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace truestep {

/// Error bad_request with a pointer to every member that is not one of these.
void require_members(const boost::json::object& body, std::span<const std::string_view> members);

/// A finite number of an object in [min, max]; Error bad_request with its pointer otherwise.
double number_member(const boost::json::object& o, const char* name, double min, double max);
/// The same for an integer; 2.0 is accepted.
uint64_t integer_member(const boost::json::object& o, const char* name, uint64_t max);

/// True or false; false when it is absent.
bool boolean_member(const boost::json::object& o, const char* name);

/// An array of at most `most` elements; null when it is absent.
const boost::json::array* array_member(const boost::json::object& o, const char* name, size_t most);
/// The same of names; empty when it is absent.
std::vector<std::string> names_member(const boost::json::object& o, const char* name, size_t most);

}  // namespace truestep
