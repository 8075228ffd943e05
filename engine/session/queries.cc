#include "engine/session/queries.h"

#include <algorithm>
#include <deque>

#include "engine/base/errors.h"
#include "engine/collision/queries/queries.h"
#include "engine/core/ports/ports.h"
#include "engine/scene/params/params.h"
#include "engine/scene/params/params_text.h"

namespace truestep {

namespace json = boost::json;

namespace {

// All tables describe the same struct; a query type exposes the members that it uses.
struct Query {
  std::vector<std::string> systems;  ///< ids; empty: all
  Vec3 at, direction{1, 0, 0};
  double reach = 1e6;  ///< m
  int64_t limit = 16;
  std::optional<double> radius;
  std::optional<Vec3> half_extents;
};

constexpr double kFar = 1e9;
constexpr Limits kLimit{1, 10000};

DefTable ray_table() {
  return TableOf<Query>("hits of a ray, nearest first")
      .vector("origin", &Query::at, "m", any(), "start of the ray")
      .required()
      .vector("direction", &Query::direction, "1", any(), "direction of the ray, of any length but zero")
      .required()
      .number("max_distance", &Query::reach, "m", {0, kFar}, "length of the ray")
      .integer("limit", &Query::limit, kLimit, "most hits")
      .texts("systems", &Query::systems, {0, 256}, "ids of the systems to search; all if absent")
      .check([](const Query& q, const DefTable::Report& report) {
        if (!(norm(q.direction) > 0)) report("/direction", "a direction must not be zero");
      })
      .build();
}
DefTable nearest_table() {
  return TableOf<Query>("items nearest to a point; distances inside solids are negative")
      .vector("point", &Query::at, "m", any(), "the point")
      .required()
      .number("within", &Query::reach, "m", {0, kFar}, "largest distance")
      .integer("limit", &Query::limit, kLimit, "most hits")
      .texts("systems", &Query::systems, {0, 256}, "ids of the systems to search; all if absent")
      .build();
}
DefTable overlap_table() {
  return TableOf<Query>("items that overlap a ball or an axis-aligned box")
      .vector("center", &Query::at, "m", any(), "its middle")
      .required()
      .number("radius", &Query::radius, "m", above(0), "of a ball")
      .vector("half_extents", &Query::half_extents, "m", above(0), "of a box")
      .integer("limit", &Query::limit, kLimit, "most items")
      .texts("systems", &Query::systems, {0, 256}, "ids of the systems to search; all if absent")
      .check([](const Query& q, const DefTable::Report& report) {
        if (q.radius.has_value() == q.half_extents.has_value())
          report("", "give either radius or half_extents");
      })
      .build();
}
DefTable contacts_table() {
  return TableOf<Query>("contacts of bodies, with the force of the last step")
      .integer("limit", &Query::limit, kLimit, "most contacts")
      .build();
}

json::array triple(const Vec3& v) {
  return {v.x, v.y, v.z};
}

Quat quaternion(const std::array<double, 4>& o) {
  return normalized(Quat{o[0], o[1], o[2], o[3]});
}

Solid solid_of(const DrawnShape& s) {
  using Kind = DrawnShape::Kind;
  switch (s.kind) {
    case Kind::plane:
      return plane_solid(s.size);
    case Kind::box:
      return box_solid(s.size);
    case Kind::sphere:
      return sphere_solid(s.size.x);
    case Kind::capsule:
      return capsule_solid(s.size.x, s.size.y);
    case Kind::cylinder:
      return cylinder_solid(s.size.x, s.size.y);
    case Kind::mesh:
      break;
  }
  std::vector<Vec3> vertices;
  for (size_t i = 0; i + 2 < s.mesh->positions.size(); i += 3)
    vertices.push_back({s.mesh->positions[i], s.mesh->positions[i + 1], s.mesh->positions[i + 2]});
  return mesh_solid(std::move(vertices), s.mesh->triangles);
}

/// Something that can be found: a placed solid, or (null) a point without extent.
struct Item {
  const Solid* solid = nullptr;
  Pose pose;
  std::string_view system, part;  ///< ids; its own id for a shape that no row carries
  std::optional<size_t> row;
};

/// Everything that a state shows. Refers to the session.
class Things {
 public:
  Things(const Session& session, const std::vector<std::string>& systems) : session_(session) {
    const World& world = session.world();
    FrameRequest request;
    request.wishes = Wish::constant;
    frame_ = session.frame(request);
    for (size_t p = 0; p < world.parts().size(); ++p) {
      const auto& part = world.parts()[p];
      const bool asked = systems.empty() ||
                         std::find(systems.begin(), systems.end(), world.id(part.system)) != systems.end();
      if (asked && part.info().kind == PartInfo::Kind::points) add_part(p);
    }
    // Shapes that no system's rows carry belong to all systems.
    if (!systems.empty()) return;
    for (size_t i = 0; i < world.size(); ++i) {
      if (!has_solids(world.system(i).ports())) add_obstacles(i);
    }
  }
  const std::vector<Item>& items() const { return items_; }

 private:
  // Whether rows carry all that is there: what such a system draws as obstacles are rows too (planes).
  static bool has_solids(const Ports& ports) { return ports.bodies && !ports.bodies->access(); }

  void add_obstacles(size_t system) {
    Drawing& drawing = drawn_.emplace_back();
    session_.world().system(system).draw(session_.state().systems[system], session_.time(), Wish::obstacles,
                                         drawing);
    for (const DrawnShape& s : drawing.obstacles) {
      if (s.container) continue;
      own_.push_back(solid_of(s));
      items_.push_back({&own_.back(), {s.position, quaternion(s.orientation)}, "", s.id, std::nullopt});
    }
  }

  void add_part(size_t p) {
    const World& world = session_.world();
    const auto& part = world.parts()[p];
    const State& state = session_.state().systems[part.system];
    const std::string_view system = world.id(part.system);
    const Ports ports = world.system(part.system).ports();
    if (part.index == 0 && has_solids(ports)) {
      const ConstBodies bodies(state, *ports.bodies);
      for (size_t k = 0; k < bodies.count(); ++k) {
        if (bodies.form(k).solid)
          items_.push_back(
              {bodies.form(k).solid, {bodies.place(k), bodies.orientation(k)}, system, part.id, k});
      }
      return;
    }
    std::vector<double> memory, turns;
    const auto position = part.info().find(Meaning::position);
    if (!position) return;
    const FieldView x = part.field(state, *position, memory);
    const auto place = [&](size_t k) {
      return Vec3{element(x, 3 * k), element(x, 3 * k + 1), element(x, 3 * k + 2)};
    };
    const PartDrawing& drawing = frame_->constant->parts[p];
    if (const auto turn = part.info().find(Meaning::orientation); turn && !drawing.instances.empty()) {
      const FieldView q = part.field(state, *turn, turns);
      for (const Visual& visual : drawing.visuals) own_.push_back(solid_of(visual.shape));
      const size_t first = own_.size() - drawing.visuals.size();
      for (const auto& [row, which] : drawing.instances) {
        if (row >= x.rows || row >= q.rows || which >= drawing.visuals.size()) continue;
        const Quat body = normalized(Quat{element(q, 4 * row), element(q, 4 * row + 1),
                                          element(q, 4 * row + 2), element(q, 4 * row + 3)});
        const DrawnShape& shape = drawing.visuals[which].shape;
        const Vec3 at = place(row) + rotation(body).apply(shape.position);
        items_.push_back(
            {&own_[first + which], {at, body * quaternion(shape.orientation)}, system, part.id, row});
      }
      return;
    }
    const Solid* ball = nullptr;
    if (drawing.point_radius > 0) ball = &own_.emplace_back(sphere_solid(drawing.point_radius));
    for (size_t k = 0; k < x.rows; ++k) items_.push_back({ball, {place(k), {}}, system, part.id, k});
  }

  const Session& session_;
  FramePtr frame_;
  std::deque<Solid> own_;      ///< keeps its addresses
  std::deque<Drawing> drawn_;  ///< keeps the ids of obstacles
  std::vector<Item> items_;
};

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

json::object ray(const Session& session, const Query& q) {
  const Things things(session, q.systems);
  const Ray ray{q.at, normalized(q.direction, {1, 0, 0})};
  std::vector<Hit> hits;
  for (const Item& item : things.items()) {
    if (!item.solid) continue;
    if (const auto hit = ray_cast(*item.solid, transform_of(item.pose), ray, q.reach))
      hits.push_back({&item, hit->t, ray.origin + ray.direction * hit->t, hit->normal});
  }
  return {{"hits", describe(std::move(hits), q.limit)}};
}

json::object nearest(const Session& session, const Query& q) {
  const Things things(session, q.systems);
  std::vector<Hit> hits;
  for (const Item& item : things.items()) {
    if (!item.solid) {
      const Vec3 away = q.at - item.pose.position;
      if (norm(away) <= q.reach)
        hits.push_back({&item, norm(away), item.pose.position, normalized(away, {0, 1, 0})});
    } else if (const auto n = nearest_point(*item.solid, transform_of(item.pose), q.at, q.reach)) {
      hits.push_back({&item, n->distance, n->point, n->normal});
    }
  }
  return {{"hits", describe(std::move(hits), q.limit)}};
}

json::object overlap(const Session& session, const Query& q) {
  const Things things(session, q.systems);
  const Solid probe = q.radius ? sphere_solid(*q.radius) : box_solid(*q.half_extents);
  const Transform at = transform_of(Pose{q.at, {}});
  json::array out;
  for (const Item& item : things.items()) {
    if (out.size() == static_cast<size_t>(q.limit)) break;
    const bool inside = item.solid ? truestep::overlap(probe, at, *item.solid, transform_of(item.pose))
                                   : nearest_point(probe, at, item.pose.position, kFar)->distance <= 0;
    if (inside) out.push_back(describe(item));
  }
  return {{"items", std::move(out)}};
}

json::object contacts(const Session& session, const Query& q) {
  FrameRequest request;
  request.wishes = Wish::contacts;
  const FramePtr frame = session.frame(request);
  json::array out;
  for (const ContactMark& c : frame->moving.contacts) {
    if (out.size() == static_cast<size_t>(q.limit)) break;
    out.push_back(json::object{{"point", triple(c.point)}, {"normal", triple(c.normal)}, {"force", c.force}});
  }
  return {{"contacts", std::move(out)}};
}

}  // namespace

std::span<const QueryType> query_types() {
  static const DefTable kRay = ray_table(), kNearest = nearest_table(), kOverlap = overlap_table(),
                        kContacts = contacts_table();
  static const QueryType kTypes[] = {
      {"ray", &kRay}, {"nearest", &kNearest}, {"overlap", &kOverlap}, {"contacts", &kContacts}};
  return kTypes;
}

namespace {

void require_systems(const World& world, const std::vector<std::string>& wanted) {
  std::vector<std::string> ids;
  for (size_t i = 0; i < world.size(); ++i) ids.push_back(world.id(i));
  for (const std::string& id : wanted) {
    if (std::find(ids.begin(), ids.end(), id) != ids.end()) continue;
    throw Error("bad_query", "no system has this id",
                {"/systems", "unknown_system", "no system has this id", '"' + id.substr(0, 64) + '"',
                 join_names(ids), nearest_name(id, ids), ""});
  }
}

}  // namespace

PreparedQuery read_query(const World& world, const json::value& document) {
  using Answer = json::object (*)(const Session&, const Query&);
  constexpr Answer kAnswers[] = {ray, nearest, overlap, contacts};
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
    require_systems(world, query.systems);
    return [query = std::move(query), answer = kAnswers[i]](const Session& session) {
      json::object out{{"step", session.step_index()}, {"time", session.time()}};
      for (auto& [key, value] : answer(session, query)) out[key] = std::move(value);
      return out;
    };
  }
  throw Error("bad_query", "no query has this type",
              {"/type", type ? "unknown_choice" : "missing", "no query has this type",
               type ? shorten(*type) : "", join_names(names), nearest_name(name, names), ""});
}

json::object answer_query(const Session& session, const json::value& document) {
  return read_query(session.world(), document)(session);
}

}  // namespace truestep
