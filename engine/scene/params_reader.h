// Reads one object against a table and keeps the place in the document for the faults it finds; private to
// read_params. A fault never stops the reading.
#pragma once
#include <boost/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/errors.h"
#include "engine/core/def.h"

namespace truestep {

class ParamReader {
 public:
  explicit ParamReader(std::vector<Issue>& issues) : issues_(issues) {}

  /// Every key of `o` into `owner`; see read_params.
  void object(const DefTable& table, void* owner, const boost::json::object& o, const std::string& pointer,
              std::span<const std::string_view> also_allowed);

 private:
  void fault(const std::string& pointer, const char* code, const std::string& message,
             const boost::json::value& value, const std::string& allowed, const std::string& unit = "",
             const std::string& did_you_mean = "");

  // One value of a kind; false after a fault.
  bool number(const ParamRow& r, const boost::json::value& v, const std::string& where, double& out);
  bool integer(const ParamRow& r, const boost::json::value& v, const std::string& where, int64_t& out);
  bool vector(const ParamRow& r, const boost::json::value& v, const std::string& where, Vec3& out);
  bool text(const ParamRow& r, const boost::json::value& v, const std::string& where, std::string& out);
  bool named_shape(const ParamRow& r, const boost::json::value& v, const std::string& where);
  bool array_shape(const ParamRow& r, const boost::json::value& v, const std::string& where);

  // The value of a row into its owner.
  void row(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where);
  void named_numbers(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where);
  void named_texts(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where);
  void choice(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where);
  void objects(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where);
  void variant(const ParamRow& r, void* owner, const boost::json::value& e, const std::string& where);
  void nested(const DefTable& table, void* owner, const boost::json::object& o, const std::string& where,
              std::span<const std::string_view> also_allowed);
  template <class T, class ReadOne>
  void array(const ParamRow& r, void* owner, const boost::json::value& v, const std::string& where,
             ReadOne read_one);

  std::vector<Issue>& issues_;
};

}  // namespace truestep
