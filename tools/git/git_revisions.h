// Circuit files as git remembers them.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/git/temporary_folder.h"

namespace tectum {

/// All files of one commit, unpacked beside each other, so that what a circuit file refers to is that commit's too.
class GitTree {
 public:
  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  /// `text` with this folder's name, wherever it comes up, replaced by "REVISION:".
  [[nodiscard]] std::string named(std::string text) const;

 private:
  friend class GitRevisions;
  TemporaryFolder folder_;
  std::string revision_;
};

/// What became of a circuit file between the two.
struct CircuitChange {
  enum class Kind { Changed, New, Gone };
  Kind kind;
  std::string file;  // from the repository's root
};

/// Two states of a repository: a commit, and a second one or the files as they lie there now.
class GitRevisions {
 public:
  /// `revisions`: "REV" (against the files that lie there), "A..B", or "A...B" (B against where it left A).
  /// `place`: a folder of the repository. error() says in one line what is wrong.
  GitRevisions(const std::string& revisions, const std::filesystem::path& place);

  [[nodiscard]] const std::string& error() const { return error_; }
  [[nodiscard]] const std::filesystem::path& root() const { return root_; }
  [[nodiscard]] const GitTree& first() const { return *first_; }
  /// Null: the files that lie there.
  [[nodiscard]] const GitTree* second() const { return second_.get(); }
  [[nodiscard]] std::filesystem::path second_folder() const { return second_ ? second_->path() : root_; }
  /// Circuit files under `folder` that differ, themselves or in a file that they refer to, in the order of their names.
  [[nodiscard]] std::vector<CircuitChange> changed_circuits(const std::filesystem::path& folder);

 private:
  [[nodiscard]] std::optional<std::string> git(std::vector<std::string> arguments);
  [[nodiscard]] std::optional<std::string> commit_of(const std::string& name);
  [[nodiscard]] std::unique_ptr<GitTree> unpack(const std::string& commit, const std::string& name);

  std::filesystem::path root_;
  std::string first_commit_, second_commit_;
  std::unique_ptr<GitTree> first_, second_;
  std::string error_;
};

/// Whether the text is a circuit file with neurons of its own or of a file that it extends: no head, protocol or test.
[[nodiscard]] bool is_circuit_text(const std::string& text);

}  // namespace tectum
