#pragma once

#include <functional>
#include <string>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/parse/json_tree.h"

namespace tectum {

/// Reads the file that a circuit names. Gets the path as resolved against the naming file's directory.
using SourceReader = std::function<ReadSource(const std::string& path)>;

inline constexpr std::size_t kMaxComposedFiles = 64;

/// Follows the keys `include` and `extends` of a circuit until one tree holds all of it.
///   include  the other file's declarations join this file's; one name in both is an error
///   extends  the other file is a whole circuit; this file's members replace its members of the same name, object by
///            object, and null removes one
/// A file that cannot be read is reported, and the tree is then not whole. Adds every file read to `sources`. Needs:
/// the tree of `file`. Nodes keep the spans of the file they come from.
[[nodiscard]] JsonTree compose(JsonTree tree, FileId file, const SourceReader& read, Sources& sources,
                               Diagnostics& diagnostics);

/// `path` seen from the directory of the file called `from`.
[[nodiscard]] std::string resolve_path(const std::string& from, const std::string& path);

}  // namespace tectum
