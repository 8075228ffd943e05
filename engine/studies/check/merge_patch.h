// JSON merge patch (RFC 7396): a document that says how another differs from it.
#pragma once
#include <boost/json.hpp>

namespace truestep {

/// Members of `patch` replace those of `target`, objects member by member; null removes.
void merge_patch(boost::json::value& target, const boost::json::value& patch);

}  // namespace truestep
