#include "server/net/http/router.h"

#include "engine/base/errors.h"

namespace truestep::net {

// A trie over segments: literal children first, then the named one, then the rest of the path.
struct Router::Node {
  std::vector<std::pair<std::string, std::unique_ptr<Node>>> literals;
  std::unique_ptr<Node> named, rest;
  std::string name;  ///< under which this node's segment is reported
  std::array<const Route*, kMethods> routes{};
  bool used = false;
};

Router::Router() : root_(std::make_unique<Node>()) {}
Router::~Router() = default;
Router::Router(Router&&) noexcept = default;
Router& Router::operator=(Router&&) noexcept = default;

Route& Router::websocket(std::string pattern, std::string summary, std::vector<std::string> subprotocols,
                         WebSocketOpener open) {
  Route row;
  row.pattern = std::move(pattern);
  row.summary = std::move(summary);
  row.subprotocols = std::move(subprotocols);
  row.open_websocket = std::move(open);
  return insert(std::move(row));
}

Route& Router::insert(Route row) {
  const auto bad = [&](const char* why) { return Error("internal", "route " + row.pattern + ": " + why); };
  std::string_view path = row.pattern;
  if (path.empty() || path[0] != '/') throw bad("a pattern starts with '/'");
  Node* node = root_.get();
  while (path.size() > 1) {
    path.remove_prefix(1);
    const std::string_view segment = path.substr(0, path.find('/'));
    path.remove_prefix(segment.size());
    if (node->name.ends_with("...")) throw bad("nothing can follow the rest of a path");
    if (segment.starts_with('{')) {
      if (!segment.ends_with('}')) throw bad("a named segment ends in '}'");
      const std::string name(segment.substr(1, segment.size() - 2));
      std::unique_ptr<Node>& child = name.ends_with("...") ? node->rest : node->named;
      if (!child) {
        child = std::make_unique<Node>();
        child->name = name;
      }
      if (child->name != name) throw bad("two names for one segment");
      node = child.get();
    } else {
      Node* next = nullptr;
      for (auto& [text, child] : node->literals) {
        if (text == segment) next = child.get();
      }
      if (!next) {
        node->literals.emplace_back(segment, std::make_unique<Node>());
        next = node->literals.back().second.get();
      }
      node = next;
    }
  }
  const Route*& slot = node->routes[static_cast<size_t>(row.method)];
  if (slot) throw bad("already in the table");
  node->used = true;
  Route& stored = rows_.emplace_back(std::move(row));
  slot = &stored;
  return stored;
}

const Router::Node* Router::walk(const Node& node, Request& request, size_t depth) const {
  if (depth == request.segments.size() && node.used) return &node;
  if (depth < request.segments.size()) {
    const std::string_view segment = request.segments[depth];
    for (const auto& [text, child] : node.literals) {
      if (text != segment) continue;
      if (const Node* found = walk(*child, request, depth + 1)) return found;
    }
    if (node.named && !segment.empty()) {
      request.params.push_back({node.named->name, segment});
      if (const Node* found = walk(*node.named, request, depth + 1)) return found;
      request.params.pop_back();
    }
  }
  if (node.rest && depth < request.segments.size()) {
    // The rest as sent: its slashes separate, so it is cut from the raw path; segments hold it decoded.
    std::string_view name = node.rest->name;
    name.remove_suffix(3);
    std::string_view raw = request.raw_path;
    for (size_t i = 0; i <= depth; ++i)
      raw.remove_prefix(raw.find('/', i == 0 ? 0 : 1) + (i == depth ? 1 : 0));
    request.params.push_back({name, raw});
    return node.rest.get();
  }
  return nullptr;
}

Router::Match Router::find(Request& request) const {
  Match m;
  request.params.clear();
  const Node* node = walk(*root_, request, 0);
  if (!node) return m;
  m.path_known = true;
  m.route = node->routes[static_cast<size_t>(request.method)];
  if (!m.route && request.method == Method::head) m.route = node->routes[static_cast<size_t>(Method::get)];
  if (m.route) return m;
  for (size_t i = 0; i < kMethods; ++i) {
    if (!node->routes[i]) continue;
    if (!m.allow.empty()) m.allow += ", ";
    m.allow += method_name(static_cast<Method>(i));
    if (static_cast<Method>(i) == Method::get) m.allow += ", HEAD";
  }
  m.allow += ", OPTIONS";
  return m;
}

}  // namespace truestep::net
