#include "engine/studies/study.h"

#include <array>

#include "engine/base/errors.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/scene/params/params.h"
#include "engine/scene/scene.h"
#include "engine/studies/convergence.h"
#include "engine/studies/cross_check.h"
#include "engine/studies/precision/work_precision.h"
#include "engine/studies/stability.h"
#include "engine/studies/sweep.h"

namespace truestep {

namespace json = boost::json;

void StudyContext::check() const {
  if (cancelled.load(std::memory_order_relaxed)) throw Error("cancelled", "the study was cancelled");
}

std::span<const StudyKind> study_kinds() {
  static const std::array kKinds = {
      StudyKind{"work_precision", "run time against error of many methods", work_precision_table,
                run_work_precision},
      StudyKind{"convergence", "observed order of one method", convergence_table, run_convergence},
      StudyKind{"stability", "largest stable steps and theory", stability_table, run_stability},
      StudyKind{"cross_check", "difference between two computations", cross_check_table, run_cross_check},
      StudyKind{"sweep", "measured quantities over parameters of the scene", sweep_table, run_sweep},
  };
  return kKinds;
}

const StudyKind* find_study_kind(std::string_view name) {
  for (const StudyKind& k : study_kinds()) {
    if (k.name == name) return &k;
  }
  return nullptr;
}

namespace {

const json::object& object_of(const json::value& request) {
  if (!request.is_object()) {
    throw Error("scene_invalid", "a study request must be an object",
                {"", "wrong_type", "an object", shorten(request), "object", "", ""});
  }
  return request.as_object();
}

}  // namespace

StudyRequest read_study_request(const json::value& request) {
  const json::object& o = object_of(request);
  std::vector<std::string> names;
  std::string all;
  for (const StudyKind& k : study_kinds()) {
    names.emplace_back(k.name);
    all += (all.empty() ? "" : ", ") + names.back();
  }
  const json::value* kind = o.if_contains("kind");
  const std::string wanted = kind && kind->is_string() ? std::string(kind->as_string()) : "";
  const StudyKind* found = find_study_kind(wanted);
  if (!found) {
    throw Error("scene_invalid", "there is no such kind of study",
                {"/kind", "unknown_choice", "there is no such kind of study", kind ? shorten(*kind) : "", all,
                 nearest_name(wanted, names), ""});
  }
  json::value rest = request;
  rest.as_object().erase("kind");
  return read_request_of(*found, rest);
}

StudyRequest read_request_of(const StudyKind& study, const json::value& request) {
  const json::object& o = object_of(request);
  StudyRequest out;
  out.kind = &study;
  std::vector<Issue> issues;
  const json::value *scene = o.if_contains("scene"), *gallery_name = o.if_contains("gallery");
  if (!scene == !gallery_name) {
    issues.push_back({"", "inconsistent", "give either \"scene\" or \"gallery\"", "", "", "", ""});
  } else if (scene) {
    out.scene = *scene;
  } else {
    const GalleryScene* g =
        gallery_name->is_string()
            ? find_gallery_scene({gallery_name->as_string().data(), gallery_name->as_string().size()})
            : nullptr;
    if (g) {
      out.scene = parse_json(g->text);
    } else {
      issues.push_back({"/gallery", "unknown_choice", "the gallery has no such scene", shorten(*gallery_name),
                        "a name of GET /v1/gallery", "", ""});
    }
  }
  if (!out.scene.is_null()) {
    for (Issue i : read_scene(out.scene).errors) {
      i.pointer = "/scene" + i.pointer;
      issues.push_back(std::move(i));
    }
  }
  constexpr std::array<std::string_view, 2> kOwn = {"scene", "gallery"};
  out.def = out.kind->table().make();
  read_params(out.kind->table(), out.def.get(), o, "", kOwn, issues);
  if (!issues.empty()) {
    const std::string first = issues.front().message;
    throw Error("scene_invalid", first, std::move(issues));
  }
  // Studies choose methods and steps themselves; a companion run would only distort the timing.
  out.scene.as_object().erase("accuracy");
  return out;
}

StudyResult run_study(const StudyRequest& request, StudyContext& context) {
  StudyResult r = request.kind->run(request.scene, request.def.get(), context);
  json::object summary{{"kind", request.kind->name}};
  if (const json::value* name = request.scene.as_object().if_contains("name")) summary["scene"] = *name;
  for (auto& [key, value] : r.summary) summary[key] = std::move(value);
  r.summary = std::move(summary);
  context.progress(1, "done");
  return r;
}

}  // namespace truestep
