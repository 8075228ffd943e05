// /v1/assets/{sha256}: JSON values, mesh and motion files that scenes refer to.
#include "engine/scene/json/json_write.h"
#include "server/api/requests.h"

namespace truestep {

namespace json = boost::json;
using net::Method;
using net::Request;
using net::Response;

namespace {

constexpr size_t kMostAsset = size_t{64} << 20;  // bytes

Task<Response> put(App& app, const Request& request) {
  const auto kind = is_json(request) ? AssetStore::Kind::json : AssetStore::Kind::file;
  require_media(request, kind == AssetStore::Kind::json ? "application/json" : "application/octet-stream");
  const std::string sha256(request.param("sha256"));
  const auto lease = app.memory.lease(3.5 * static_cast<double>(request.body.size()), "reading the body");
  auto keep = [&app, &request, sha256, kind] {
    app.require_folder();
    const bool fresh = app.assets.put(sha256, request.body, kind, request.caller);
    const std::string self = "/v1/assets/" + sha256;
    Response r = json_response(
        json::object{
            {"sha256", sha256}, {"bytes", request.body.size()}, {"links", json::object{{"self", self}}}},
        fresh ? 201 : 200);
    if (fresh) r.header("Location", self);
    return r;
  };
  co_return co_await app.runner.long_work(std::move(keep));
}

}  // namespace

void add_asset_routes(net::Router& router, App& app) {
  const std::string asset = "/v1/assets/{sha256}";
  router
      .add(Method::put, asset,
           "Stores a JSON value, or a file (OBJ, STL, PLY, MSH, BVH, text), under its SHA-256: scenes refer "
           "to it as {\"asset\": sha256}",
           [&app](const Request& r) { return put(app, r); })
      .max_body = kMostAsset;
  router.add(Method::get, asset, "An asset", [&app](const Request& r) -> Task<Response> {
    auto read = [&app, sha256 = std::string(r.param("sha256"))] {
      AssetStore::Asset asset = app.assets.get(sha256);
      if (asset.kind == AssetStore::Kind::json) return Response::json(std::move(asset.bytes));
      return Response::text(asset.bytes, "application/octet-stream");
    };
    co_return co_await offload(app.runner.pool(), std::move(read));
  });
  router.add(Method::delete_, asset, "Removes an asset; sessions created with it keep its value",
             [&app](const Request& r) -> Task<Response> {
               auto remove = [&app, &r, sha256 = std::string(r.param("sha256"))] {
                 app.assets.remove(sha256, r.caller);
                 return Response(204);
               };
               co_return co_await offload(app.runner.pool(), std::move(remove));
             });
}

}  // namespace truestep
