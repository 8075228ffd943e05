// A table's rows for human readers: documentation, the command line, the web form.
#include <iterator>

#include "engine/scene/params/params.h"
#include "engine/scene/params/params_text.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr const char* kKindNames[] = {
    "number",   "integer", "boolean", "string", "expression", "choice",   "vector",        "numbers",
    "integers", "vectors", "strings", "object", "objects",    "variants", "named numbers", "named strings"};
static_assert(std::size(kKindNames) == static_cast<size_t>(ParamKind::named_texts) + 1);

}  // namespace

json::array describe_params(const DefTable& table) {
  const auto defaults = table.make();
  const json::object values = write_params(table, defaults.get());
  json::array rows;
  for (const ParamRow& r : table.rows) {
    json::object row{
        {"name", r.name}, {"kind", kKindNames[static_cast<size_t>(r.kind)]}, {"description", r.sentence}};
    if (!r.unit.empty()) row["unit"] = r.unit;
    if (r.presence == Presence::required) row["required"] = true;
    if (r.kind == ParamKind::number || r.kind == ParamKind::integer) row["allowed"] = limits_text(r.limits);
    if (!r.choices.empty()) row["choices"] = json::array(r.choices.begin(), r.choices.end());
    if (r.nested) row["parameters"] = describe_params(*r.nested);
    if (!r.variants.empty()) {
      json::object types;
      for (const ParamVariant& v : r.variants) types[v.type] = describe_params(*v.table);
      row["types"] = std::move(types);
    } else if (!r.nested && r.presence == Presence::optional) {
      if (const json::value* v = values.if_contains(r.name)) row["default"] = *v;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace truestep
