// Reads one object against a table and keeps the place in the document for the faults it finds; private to
// read_params. A fault never stops the reading.
#pragma once
#include <boost/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/errors.h"
#include "engine/core/def/def.h"
#include "engine/scene/params/params.h"

namespace truestep {

/// The value in the document at a fault; empty when it is missing.
struct FoundValue {
  std::string text;
  FoundValue() = default;
  FoundValue(const boost::json::value& value) : text(shorten(value)) {}  // NOLINT: implicit on purpose
};

/// The only fault that does not spoil a member.
inline constexpr std::string_view kUnknownKey = "unknown_key";

class ParamReader {
 public:
  static constexpr size_t kMostFaults = 100;

  explicit ParamReader(std::vector<Issue>& issues) : issues_(issues) {}

  /// Reads every key of `o` into `owner`, then runs the table's checks across members if each member is good;
  /// see read_params.
  void object(const DefTable& table, void* owner, const boost::json::object& o, const std::string& pointer,
              std::span<const std::string_view> also_allowed);
  /// A document can contain millions of faults; nobody reads more than a screenful, and nothing is searched
  /// for faults that are not listed.
  bool full() const { return issues_.size() >= kMostFaults; }
  /// Faulty when a member has an unacceptable value; unknown keys do not count.
  Reading reading() const { return bad_members_ == 0 ? Reading::sound : Reading::faulty; }

 private:
  void fault(const std::string& pointer, std::string_view code, const std::string& message,
             const FoundValue& found, const std::string& allowed, const std::string& unit = "",
             const std::string& did_you_mean = "");
  void members(const DefTable& table, void* owner, const boost::json::object& o, const std::string& pointer,
               std::span<const std::string_view> also_allowed);

  // Reads one value of a kind; false after a fault.
  bool number(const ParamRow& r, const boost::json::value& v, const std::string& where, double& out);
  bool integer(const ParamRow& r, const boost::json::value& v, const std::string& where, int64_t& out);
  bool vector(const ParamRow& r, const boost::json::value& v, const std::string& where, Vec3& out);
  bool text(const ParamRow& r, const boost::json::value& v, const std::string& where, std::string& out);
  bool named_shape(const ParamRow& r, const boost::json::value& v, const std::string& where);
  bool array_shape(const ParamRow& r, const boost::json::value& v, const std::string& where);

  // Reads the value of a row into its owner.
  void row(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where);
  void named_numbers(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where);
  void named_texts(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where);
  void choice(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where);
  void objects(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where);
  void variant(const ParamRow& r, void* owner, const boost::json::value& e, const std::string& where);
  template <class T, class ReadOne>
  void array(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where,
             ReadOne read_one);

  std::vector<Issue>& issues_;
  size_t bad_members_ = 0;  ///< members with an unacceptable value
};

}  // namespace truestep
