#include "engine/session/queries/queries.h"

#include <algorithm>

#include "engine/base/error_place.h"
#include "engine/base/interrupt.h"
#include "engine/scene/params/params.h"
#include "engine/scene/params/params_text.h"

namespace truestep {

namespace json = boost::json;

namespace {

/// A solid that is no part of the scene.
struct ProbeShape {
  enum class Kind : uint8_t { sphere, capsule, cylinder, box } type = Kind::sphere;
  double radius = 0.5, half_length = 0.5;  ///< m
  Vec3 half_extents{0.5, 0.5, 0.5};        ///< m
};
/// A row that a query does not see.
struct ExceptedRow {
  std::string system;
  int64_t index = 0;
};

// All tables describe the same struct; a query type exposes the members that it uses.
struct Query {
  std::vector<std::string> systems;  ///< ids; empty: all
  std::vector<ExceptedRow> except;
  Vec3 at, direction{1, 0, 0};
  std::vector<double> orientation{1, 0, 0, 0};
  double reach = 1e6;  ///< m
  int64_t limit = 16;
  std::optional<double> radius;
  std::optional<Vec3> half_extents;
  std::optional<ProbeShape> shape;
};

constexpr double kFar = 1e9;
constexpr Limits kLimit{1, 10000};

const DefTable& shape_table() {
  static const DefTable t =
      TableOf<ProbeShape>("a solid")
          .choice("type", &ProbeShape::type, {"sphere", "capsule", "cylinder", "box"}, "what it is")
          .required()
          .number("radius", &ProbeShape::radius, "m", above(0), "of a sphere, capsule or cylinder")
          .number("half_length", &ProbeShape::half_length, "m", above(0),
                  "of a capsule without its ends, or of a cylinder; along y")
          .vector("half_extents", &ProbeShape::half_extents, "m", above(0), "of a box")
          .build();
  return t;
}

const DefTable& except_table() {
  static const DefTable t =
      TableOf<ExceptedRow>("a row that is not seen")
          .text("system", &ExceptedRow::system, "id of its system")
          .required()
          .integer("index", &ExceptedRow::index, {0, 1 << 30}, "row, as answers give it")
          .required()
          .build();
  return t;
}

// What all queries of solids take.
DefTable finished(TableOf<Query>& table, const char* most) {
  return table.integer("limit", &Query::limit, kLimit, most)
      .texts("systems", &Query::systems, {0, 256}, "ids of the systems to search; all if absent")
      .objects("except", &Query::except, except_table(), {0, 256}, "rows that are passed over")
      .build();
}

void require_direction(const Query& q, const DefTable::Report& report) {
  if (!(norm(q.direction) > 0)) report("/direction", "a direction must not be zero");
}
void require_rotation(const Query& q, const DefTable::Report& report) {
  double square = 0;
  for (const double v : q.orientation) square += v * v;
  if (q.orientation.size() != 4 || !(square > 0))
    report("/orientation", "a rotation is four numbers, not all zero");
}

DefTable ray_table() {
  TableOf<Query> t("hits of a ray, nearest first");
  t.vector("origin", &Query::at, "m", any(), "start of the ray")
      .required()
      .vector("direction", &Query::direction, "1", any(), "direction of the ray, of any length but zero")
      .required()
      .number("max_distance", &Query::reach, "m", {0, kFar}, "length of the ray")
      .check(require_direction);
  return finished(t, "most hits; 1 for the first alone");
}
DefTable cast_table() {
  TableOf<Query> t("what a solid meets first on a straight way, nearest first; it does not turn");
  t.object("shape", &Query::shape, shape_table(), "what moves")
      .required()
      .vector("position", &Query::at, "m", any(), "where it starts")
      .required()
      .numbers("orientation", &Query::orientation, "1", any(), {4, 4}, "its rotation, quaternion w, x, y, z")
      .vector("direction", &Query::direction, "1", any(), "where to, of any length but zero")
      .required()
      .number("max_distance", &Query::reach, "m", {0, kFar}, "how far")
      .check([](const Query& q, const DefTable::Report& report) {
        require_direction(q, report);
        require_rotation(q, report);
      });
  return finished(t, "most hits; 1 for the first alone");
}
DefTable nearest_table() {
  TableOf<Query> t("items nearest to a point; distances inside solids are negative");
  t.vector("point", &Query::at, "m", any(), "the point")
      .required()
      .number("within", &Query::reach, "m", {0, kFar}, "largest distance");
  return finished(t, "most hits");
}
DefTable overlap_table() {
  TableOf<Query> t("items that overlap a solid");
  t.vector("center", &Query::at, "m", any(), "its middle")
      .required()
      .number("radius", &Query::radius, "m", above(0), "of a ball")
      .vector("half_extents", &Query::half_extents, "m", above(0), "of a box")
      .object("shape", &Query::shape, shape_table(), "any other")
      .numbers("orientation", &Query::orientation, "1", any(), {4, 4}, "its rotation, quaternion w, x, y, z")
      .check([](const Query& q, const DefTable::Report& report) {
        require_rotation(q, report);
        if (q.radius.has_value() + q.half_extents.has_value() + q.shape.has_value() != 1)
          report("", "give one of radius, half_extents and shape");
      });
  return finished(t, "most items");
}
DefTable contacts_table() {
  return TableOf<Query>("contacts of bodies, with the force of the last step")
      .integer("limit", &Query::limit, kLimit, "most contacts")
      .build();
}

json::array triple(const Vec3& v) {
  return {v.x, v.y, v.z};
}

using Item = Surroundings::Item;

json::object describe(const Item& item) {
  json::object o;
  o["system"] = item.system;
  if (item.part != item.system) o["part"] = item.part;
  if (item.row) o["index"] = *item.row;
  return o;
}

struct Hit {
  const Item* item;
  double distance;
  Vec3 point, normal;
};

json::array describe(std::vector<Hit> hits, int64_t limit) {
  std::stable_sort(hits.begin(), hits.end(),
                   [](const Hit& a, const Hit& b) { return a.distance < b.distance; });
  if (hits.size() > static_cast<size_t>(limit)) hits.resize(static_cast<size_t>(limit));
  json::array out;
  for (const Hit& h : hits) {
    json::object o = describe(*h.item);
    o["distance"] = h.distance, o["point"] = triple(h.point), o["normal"] = triple(h.normal);
    out.push_back(std::move(o));
  }
  return out;
}

// Visits what the query asks for among the items whose boxes pass.
template <class Passes, class Visit>
void each_wanted(Surroundings& around, const Query& q, Passes&& passes, Visit&& visit) {
  around.each(passes, [&](const Item& item) {
    // Shapes that no system's rows carry belong to all systems.
    if (!q.systems.empty() && std::find(q.systems.begin(), q.systems.end(), item.system) == q.systems.end())
      return;
    const auto is_item = [&](const ExceptedRow& r) {
      return item.row == static_cast<size_t>(r.index) && item.system == r.system;
    };
    if (std::none_of(q.except.begin(), q.except.end(), is_item)) visit(item);
  });
}

json::object ray(Surroundings& around, const Query& q) {
  const Ray ray{q.at, normalized(q.direction, {1, 0, 0})};
  std::vector<Hit> hits;
  const auto meets = [&](const FloatBox& box) { return ray_meets(box, ray, q.reach); };
  each_wanted(around, q, meets, [&](const Item& item) {
    if (!item.solid) return;
    if (const auto hit = ray_cast(*item.solid, transform_of(item.pose), ray, q.reach))
      hits.push_back({&item, hit->t, ray.origin + ray.direction * hit->t, hit->normal});
  });
  return {{"hits", describe(std::move(hits), q.limit)}};
}

Pose pose_of(const Query& q) {
  const std::vector<double>& o = q.orientation;
  return {q.at, normalized(Quat{o[0], o[1], o[2], o[3]})};
}

Solid solid_of(const ProbeShape& s) {
  switch (s.type) {
    case ProbeShape::Kind::capsule:
      return capsule_solid(s.radius, s.half_length);
    case ProbeShape::Kind::cylinder:
      return cylinder_solid(s.radius, s.half_length);
    case ProbeShape::Kind::box:
      return box_solid(s.half_extents);
    case ProbeShape::Kind::sphere:
      break;
  }
  return sphere_solid(s.radius);
}

// Points without extent are met as balls of a thousandth of the solid's size.
json::object shape_cast(Surroundings& around, const Query& q) {
  const Solid probe = solid_of(*q.shape);
  const Pose from = pose_of(q);
  const Vec3 move = normalized(q.direction, {1, 0, 0}) * q.reach;
  Box way = bounds(probe, transform_of(from));
  const double touch = 1e-4 * norm(way.high - way.low);
  const Solid speck = sphere_solid(10 * touch);
  way.cover(Box{way.low + move, way.high + move});
  const FloatBox all = FloatBox::around(way.grown(touch));
  std::vector<Hit> hits;
  const auto meets = [&](const FloatBox& box) { return box.overlaps(all); };
  each_wanted(around, q, meets, [&](const Item& item) {
    const auto hit =
        truestep::shape_cast(probe, from, move, item.solid ? *item.solid : speck, item.pose, touch);
    if (hit) hits.push_back({&item, hit->t * q.reach, hit->point, hit->normal * -1.0});
  });
  return {{"hits", describe(std::move(hits), q.limit)}};
}

json::object nearest(Surroundings& around, const Query& q) {
  std::vector<Hit> hits;
  const FloatBox all = FloatBox::around(Box{q.at, q.at}.grown(q.reach));
  const auto near = [&](const FloatBox& box) { return box.overlaps(all); };
  each_wanted(around, q, near, [&](const Item& item) {
    if (!item.solid) {
      const Vec3 away = q.at - item.pose.position;
      if (norm(away) <= q.reach)
        hits.push_back({&item, norm(away), item.pose.position, normalized(away, {0, 1, 0})});
    } else if (const auto n = nearest_point(*item.solid, transform_of(item.pose), q.at, q.reach)) {
      hits.push_back({&item, n->distance, n->point, n->normal});
    }
  });
  return {{"hits", describe(std::move(hits), q.limit)}};
}

json::object overlap(Surroundings& around, const Query& q) {
  const Solid probe = q.shape    ? solid_of(*q.shape)
                      : q.radius ? sphere_solid(*q.radius)
                                 : box_solid(*q.half_extents);
  const Transform at = transform_of(pose_of(q));
  const FloatBox all = FloatBox::around(bounds(probe, at));
  json::array out;
  const auto near = [&](const FloatBox& box) { return box.overlaps(all); };
  each_wanted(around, q, near, [&](const Item& item) {
    if (out.size() == static_cast<size_t>(q.limit)) return;
    const bool inside = item.solid ? truestep::overlap(probe, at, *item.solid, transform_of(item.pose))
                                   : nearest_point(probe, at, item.pose.position, kFar)->distance <= 0;
    if (inside) out.push_back(describe(item));
  });
  return {{"items", std::move(out)}};
}

json::object contacts(Surroundings& around, const Query& q) {
  FrameRequest request;
  request.wishes = Wish::contacts;
  const FramePtr frame = around.session().frame(request);
  json::array out;
  for (const ContactMark& c : frame->moving.contacts) {
    if (out.size() == static_cast<size_t>(q.limit)) break;
    out.push_back(json::object{{"point", triple(c.point)}, {"normal", triple(c.normal)}, {"force", c.force}});
  }
  return {{"contacts", std::move(out)}};
}

}  // namespace

std::span<const QueryType> query_types() {
  static const DefTable kRay = ray_table(), kCast = cast_table(), kNearest = nearest_table(),
                        kOverlap = overlap_table(), kContacts = contacts_table();
  static const QueryType kTypes[] = {{"ray", &kRay},
                                     {"shape_cast", &kCast},
                                     {"nearest", &kNearest},
                                     {"overlap", &kOverlap},
                                     {"contacts", &kContacts}};
  return kTypes;
}

namespace {

void require_system(const World& world, const std::string& id, const std::string& pointer) {
  std::vector<std::string> ids;
  for (size_t i = 0; i < world.size(); ++i) ids.push_back(world.id(i));
  if (std::find(ids.begin(), ids.end(), id) == ids.end()) {
    throw Error("bad_query", "no system has this id",
                {pointer, "unknown_system", "no system has this id", '"' + id.substr(0, 64) + '"',
                 join_names(ids), nearest_name(id, ids), ""});
  }
}

}  // namespace

PreparedQuery read_query(const World& world, const json::value& document) {
  using Answer = json::object (*)(Surroundings&, const Query&);
  constexpr Answer kAnswers[] = {ray, shape_cast, nearest, overlap, contacts};
  if (!document.is_object()) {
    throw Error("bad_query", "a query must be an object",
                {"", "wrong_type", "a query must be an object", shorten(document), "an object", "", ""});
  }
  const json::value* type = document.as_object().if_contains("type");
  const std::string name = type && type->is_string() ? std::string(type->as_string().c_str()) : "";
  std::vector<std::string> names;
  for (size_t i = 0; i < query_types().size(); ++i) {
    const QueryType& t = query_types()[i];
    names.emplace_back(t.name);
    if (t.name != name) continue;
    Query query;
    std::vector<Issue> issues;
    constexpr std::string_view kOwn[] = {"type"};
    read_params(*t.table, &query, document.as_object(), "", kOwn, issues);
    if (!issues.empty()) throw Error("bad_query", "the query has faults", std::move(issues));
    for (size_t k = 0; k < query.systems.size(); ++k)
      require_system(world, query.systems[k], "/systems/" + std::to_string(k));
    for (size_t k = 0; k < query.except.size(); ++k)
      require_system(world, query.except[k].system, "/except/" + std::to_string(k) + "/system");
    return [query = std::move(query), answer = kAnswers[i]](Surroundings& around) {
      const Session& session = around.session();
      json::object out{{"step", session.step_index()}, {"time", session.time()}};
      for (auto& [key, value] : answer(around, query)) out[key] = std::move(value);
      return out;
    };
  }
  throw Error("bad_query", "no query has this type",
              {"/type", type ? "unknown_choice" : "missing", "no query has this type",
               type ? shorten(*type) : "", join_names(names), nearest_name(name, names), ""});
}

json::value answer_queries(const Session& session, const json::value& documents) {
  if (!documents.is_array()) {
    Surroundings around(session, 1);
    return read_query(session.world(), documents)(around);
  }
  std::vector<PreparedQuery> queries;
  for (const json::value& document : documents.as_array()) {
    try {
      queries.push_back(read_query(session.world(), document));
    } catch (const Error& e) {
      throw placed_below(e, '/' + std::to_string(queries.size()));
    }
  }
  Surroundings around(session, queries.size());
  json::array out;
  for (const PreparedQuery& q : queries) {
    interruption_point();
    out.push_back(q(around));
  }
  return out;
}

}  // namespace truestep
