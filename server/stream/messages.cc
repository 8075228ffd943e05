#include "server/stream/messages.h"

#include <google/protobuf/util/json_util.h>

#include <map>

#include "engine/base/version.h"
#include "engine/scene/json/json.h"
#include "engine/sinks/stream/block_encoding.h"
#include "server/net/http/problem.h"

namespace truestep {

namespace {

template <class T>
std::string bytes_of(const std::vector<T>& v) {
  return {reinterpret_cast<const char*>(v.data()), v.size() * sizeof(T)};
}

void set_shape(v1::Shape& s, const DrawnShape& shape) {
  constexpr const char* kNames[] = {"plane", "box", "sphere", "capsule", "cylinder", "mesh"};
  s.set_kind(kNames[static_cast<size_t>(shape.kind)]);
  for (const double v : {shape.position.x, shape.position.y, shape.position.z}) s.add_position(v);
  for (const double v : shape.orientation) s.add_orientation(v);
  for (const double v : {shape.size.x, shape.size.y, shape.size.z}) s.add_size(v);
  s.set_id(shape.id);
  s.set_container(shape.container);
}

void set_mesh(v1::Mesh& m, const DrawnMesh& mesh) {
  m.set_positions(bytes_of(mesh.positions));
  m.set_normals(bytes_of(mesh.normals));
  m.set_triangles(bytes_of(mesh.triangles));
}

/// Adds the obstacles of a frame to a message; the meshes among them are numbered in their order.
template <class Message>
void add_obstacles(Message& m, const Frame& frame) {
  uint32_t meshes = 0;
  for (const DrawnShape& shape : frame.moving.obstacles) {
    v1::Shape& s = *m.add_shapes();
    set_shape(s, shape);
    if (shape.mesh) s.set_mesh(meshes++);
  }
}

void set_visuals(v1::SystemTopology& t, const PartDrawing& drawing) {
  std::map<const DrawnMesh*, uint32_t> meshes;
  for (const Visual& visual : drawing.visuals) {
    v1::Visual& f = *t.add_visuals();
    set_shape(*f.mutable_shape(), visual.shape);
    f.set_group(visual.group);
    f.set_motion(static_cast<v1::Motion>(visual.motion));
    if (visual.color) f.mutable_color()->Add(visual.color->begin(), visual.color->end());
    if (!visual.shape.mesh) continue;
    const DrawnMesh& mesh = *visual.shape.mesh;
    const auto [at, fresh] = meshes.try_emplace(&mesh, static_cast<uint32_t>(meshes.size()));
    f.set_mesh(at->second);
    if (!fresh) continue;
    set_mesh(*t.add_meshes(), mesh);
  }
  t.set_instances(bytes_of(drawing.instances));
}

void set_plot(v1::SystemTopology& t, const PartDrawing& drawing) {
  t.set_plane(drawing.space == PartDrawing::Space::plane);
  for (const std::string& name : drawing.curves) t.add_curves(name);
  for (const PlotAxis& axis : drawing.plot) {
    v1::PlotAxis& a = *t.add_plot();
    a.set_name(axis.name);
    a.set_unit(axis.unit);
    a.set_slope(axis.slope);
    a.set_offset(axis.offset);
    for (const auto& [value, place] : axis.decades) a.add_decades(value), a.add_decades(place);
  }
}

void set_end(v1::StringEnd& e, const World& world, const StringEnd& end) {
  if (end.part != StringEnd::kWorld) e.set_part(world.parts()[end.part].id);
  e.set_row(end.row);
  for (const double v : {end.at.x, end.at.y, end.at.z}) e.add_at(v);
}

void set_field(v1::Field& field, const FieldInfo& f) {
  field.set_name(f.name);
  field.set_unit(f.unit);
  field.set_width(f.width);
  const Scalar type = f.type == Scalar::f64 ? Scalar::f32 : f.type;
  field.set_encoding(static_cast<v1::Encoding>(plain_encoding(type)));
  field.set_meaning(std::string(name_of(f.meaning)));
  field.set_scale(std::string(name_of(f.scale)));
  for (const std::string& kind : f.kinds) field.add_kinds(kind);
}

void set_part(v1::Part& p, const PartTable::Entry& part, const std::string& system) {
  const PartInfo& info = part.info();
  p.set_id(part.id);
  p.set_system(system);
  p.set_kind(std::string(name_of(info.kind)));
  for (const FieldInfo& f : info.fields) set_field(*p.add_fields(), f);
  p.set_elements(std::string(name_of(info.elements)));
  if (info.kind != PartInfo::Kind::grid) return;
  v1::Lattice& l = *p.mutable_lattice();
  for (const uint32_t n : info.lattice.counts) l.add_counts(n);
  for (const double x : {info.lattice.origin.x, info.lattice.origin.y, info.lattice.origin.z})
    l.add_origin(x);
  for (const double x : {info.lattice.spacing.x, info.lattice.spacing.y, info.lattice.spacing.z})
    l.add_spacing(x);
  l.set_cells(info.lattice.centring == Lattice::Centring::cells);
}

void add(std::vector<float>& out, const Vec3& v) {
  for (const double c : {v.x, v.y, v.z}) out.push_back(static_cast<float>(c));
}

}  // namespace

v1::ServerMessage hello_message(const Session& session, const std::string& id) {
  v1::ServerMessage m;
  v1::Hello& h = *m.mutable_hello();
  h.set_api("truestep.v1");
  h.set_session(id);
  h.set_server(std::string(version()));
  h.set_dt(session.world().dt());
  h.set_step(session.step_index());
  h.set_scene_name(session.world().scene().header.name);
  for (const char* c : {"F32", "F64", "Q16", "Q16_DELTA", "QUAT32", "latest", "every", "commands",
                        "observables", "marks", "state_hash"})
    h.add_capabilities(c);
  for (size_t i = 0; i < session.world().size(); ++i) {
    v1::SystemInfo& info = *h.add_systems();
    info.set_id(session.world().id(i));
    info.set_type(std::string(session.world().scene().systems[i].row->type));
    const auto& parts = session.world().system(i).parts();
    for (size_t k = 0; !parts.empty() && k < parts[0].fields.size(); ++k)
      set_field(*info.add_fields(), parts[0].fields[k]);
    Observables values;
    session.world().system(i).observe(session.state().systems[i], session.time(), values);
    for (const Observation& o : values.rows()) info.add_observables(o.name);
  }
  for (const PartTable::Entry& part : session.world().parts())
    set_part(*h.add_parts(), part, session.world().id(part.system));
  return m;
}

v1::ServerMessage topology_message(const World& world, const Frame& frame) {
  v1::ServerMessage m;
  v1::Topology& t = *m.mutable_topology();
  t.set_version(frame.drawing_version);
  for (size_t i = 0; i < world.parts().size(); ++i) {
    if (world.parts()[i].info().kind == PartInfo::Kind::values) continue;
    const PartDrawing& drawing = frame.constant->parts[i];
    v1::SystemTopology& s = *t.add_systems();
    s.set_system(world.parts()[i].id);
    s.set_lines(bytes_of(drawing.lines));
    s.set_triangles(bytes_of(drawing.triangles));
    s.set_line_kind(bytes_of(drawing.line_kinds));
    s.set_triangle_elements(bytes_of(drawing.triangle_elements));
    s.set_point_radius(drawing.point_radius);
    if (drawing.color) {
      for (const double c : *drawing.color) s.add_color(c);
    }
    set_visuals(s, drawing);
    set_plot(s, drawing);
  }
  for (const DrawnString& string : frame.constant->strings) {
    v1::DrawnString& s = *t.add_strings();
    set_end(*s.mutable_a(), world, string.a);
    set_end(*s.mutable_b(), world, string.b);
  }
  add_obstacles(t, frame);
  for (const DrawnShape& shape : frame.moving.obstacles) {
    if (shape.mesh) set_mesh(*t.add_meshes(), *shape.mesh);
  }
  return m;
}

std::string shapes_fields(const Frame& frame) {
  v1::Frame m;
  add_obstacles(m, frame);
  return m.SerializeAsString();
}

std::string marks_fields(const Frame& frame) {
  v1::Frame m;
  v1::Marks& marks = *m.mutable_marks();
  std::vector<float> contacts, joints;
  std::vector<uint8_t> kinds;
  std::vector<uint32_t> rows;
  bool valued = false;
  for (const ContactMark& c : frame.moving.contacts) {
    add(contacts, c.point), add(contacts, c.normal);
    contacts.push_back(static_cast<float>(c.force));
  }
  for (const JointMark& j : frame.moving.joints) {
    add(joints, j.a), add(joints, j.b), add(joints, j.axis);
    kinds.push_back(static_cast<uint8_t>(j.kind));
    rows.insert(rows.end(), {j.part, j.row});
    valued = valued || j.row != JointMark::kNoRow;
  }
  marks.set_contacts(bytes_of(contacts));
  marks.set_joints(bytes_of(joints));
  marks.set_joint_kinds(bytes_of(kinds));
  if (valued) marks.set_joint_rows(bytes_of(rows));
  return m.SerializeAsString();
}

v1::ServerMessage playback_message(const Session& session) {
  v1::ServerMessage m;
  v1::PlaybackState& p = *m.mutable_playback();
  p.set_playing(session.playing());
  p.set_speed(session.speed());
  p.set_step(session.step_index());
  p.set_time(session.time());
  p.set_skipped_steps(session.skipped_steps());
  p.set_achieved_speed(session.achieved_speed().value_or(0));
  return m;
}

v1::ServerMessage bye_message(std::string_view code, std::string_view reason) {
  v1::ServerMessage m;
  m.mutable_bye()->set_code(std::string(code));
  m.mutable_bye()->set_reason(std::string(reason));
  return m;
}

v1::ServerMessage problem_message(std::string_view code, std::string_view detail, std::string_view request_id,
                                  std::string_view pointer) {
  const net::ProblemKind& kind = net::problem_kind(code);
  v1::ServerMessage m;
  v1::Problem& p = *m.mutable_problem();
  p.set_code(std::string(kind.code));
  p.set_title(std::string(kind.title));
  p.set_status(static_cast<uint32_t>(kind.status));
  p.set_detail(std::string(detail));
  p.set_request_id(std::string(request_id));
  p.set_pointer(std::string(pointer));
  return m;
}

net::SharedBuffer to_wire(const v1::ServerMessage& message, WireForm form) {
  auto out = std::make_shared<std::string>();
  if (form == WireForm::protobuf) {
    message.SerializeToString(out.get());
  } else {
    google::protobuf::util::JsonPrintOptions options;
    options.preserve_proto_field_names = true;
    options.always_print_primitive_fields = true;
    const auto status = google::protobuf::util::MessageToJsonString(message, out.get(), options);
    if (!status.ok()) throw Error("internal", std::string(status.message()));
  }
  return out;
}

v1::ClientMessage client_message_from_wire(std::string_view payload, WireForm form) {
  v1::ClientMessage m;
  if (form == WireForm::protobuf) {
    if (!m.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) {
      throw Error("bad_request", "the message is not a truestep.v1.ClientMessage");
    }
    return m;
  }
  parse_json(payload);  // strict about duplicates, depth and numbers; the mapping below is not
  const auto status = google::protobuf::util::JsonStringToMessage({payload.data(), payload.size()}, &m);
  if (!status.ok()) throw Error("bad_request", std::string(status.message()));
  return m;
}

}  // namespace truestep
