#include "tools/git/git_revisions.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tools/git/run_process.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

json parsed(const std::string& text) { return json::parse(text, nullptr, false, true); }

std::vector<std::string> split_at_zeros(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\0', begin);
    parts.push_back(text.substr(begin, end - begin));
    begin = end == std::string::npos ? text.size() : end + 1;
  }
  return parts;
}

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

bool is_within(const fs::path& relative) { return relative.empty() || *relative.begin() != ".."; }

/// The file and every file that a text in it names, and so on; all from `root`.
class References {
 public:
  explicit References(fs::path root) : root_(std::move(root)) {}

  [[nodiscard]] std::set<std::string> of(const std::string& file) {
    found_.clear();
    follow(file);
    return found_;
  }

 private:
  void follow(const std::string& file) {
    if (!found_.insert(file).second || fs::path(file).extension() != ".json") {
      return;
    }
    look_into(parsed(read_text(root_ / file)), fs::path(file).parent_path());
  }

  void look_into(const json& value, const fs::path& folder) {
    constexpr std::size_t kLongestName = 1024;
    if (value.is_structured()) {
      for (const json& part : value) {
        look_into(part, folder);
      }
    } else if (value.is_string() && value.get_ref<const std::string&>().size() < kLongestName) {
      const std::string name = (folder / value.get_ref<const std::string&>()).lexically_normal().generic_string();
      std::error_code ignored;
      if (is_within(name) && fs::is_regular_file(root_ / name, ignored)) {
        follow(name);
      }
    }
  }

  fs::path root_;
  std::set<std::string> found_;
};

}  // namespace

bool is_circuit_text(const std::string& text) {
  const json content = parsed(text);
  return content.is_object() && content.contains("tectum") &&
         (content.contains("populations") || content.contains("extends"));
}

std::string GitTree::named(std::string text) const {
  const std::string folder = path().generic_string();
  return replaced(replaced(std::move(text), folder + "/", revision_ + ":"), folder, revision_);
}

std::optional<std::string> GitRevisions::git(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"git", "-C", root_.string()});
  const ProcessResult result = run_process(arguments);
  if (result.status == 0) {
    return result.out;
  }
  if (error_.empty()) {
    error_ = first_line(result.err);
  }
  return std::nullopt;
}

std::optional<std::string> GitRevisions::commit_of(const std::string& name) {
  const std::string wanted = name.empty() ? "HEAD" : name;
  // Without --end-of-options a name that starts with a dash would be an option.
  const auto found = git({"rev-parse", "--verify", "--quiet", "--end-of-options", wanted + "^{commit}"});
  if (!found) {
    error_ = error_.empty() ? fmt::format("git knows no revision `{}`", wanted) : error_;
    return std::nullopt;
  }
  return first_line(*found);
}

std::unique_ptr<GitTree> GitRevisions::unpack(const std::string& commit, const std::string& name) {
  auto tree = std::make_unique<GitTree>();
  tree->revision_ = name;
  const TemporaryFolder archive;
  if (tree->path().empty() || archive.path().empty()) {
    error_ = "no temporary folder could be made";
    return tree;
  }
  const std::string file = (archive.path() / "tree.tar").string();
  if (git({"archive", "--format=tar", "-o", file, commit})) {
    const ProcessResult result = run_process({"tar", "-xf", file, "-C", tree->path().string()});
    error_ =
        result.status == 0 ? "" : fmt::format("the files of {} cannot be unpacked: {}", name, first_line(result.err));
  }
  return tree;
}

GitRevisions::GitRevisions(const std::string& revisions, const fs::path& place) : root_(place) {
  const auto top = git({"rev-parse", "--show-toplevel"});
  if (!top) {
    if (error_.find("not a git repository") != std::string::npos) {
      error_ = fmt::format("{} is in no git repository", fs::absolute(place).lexically_normal().string());
    }
    return;
  }
  root_ = first_line(*top);
  const std::size_t dots = revisions.find("..");
  const std::string first_name = revisions.substr(0, dots);
  const bool is_from_fork = dots != std::string::npos && revisions.compare(dots, 3, "...") == 0;
  const auto first = commit_of(first_name);
  if (!first) {
    return;
  }
  first_commit_ = *first;
  std::string shown = first_name.empty() ? "HEAD" : first_name;
  if (dots != std::string::npos) {
    const std::string second_name = revisions.substr(dots + (is_from_fork ? 3 : 2));
    const auto second = commit_of(second_name);
    if (!second) {
      return;
    }
    second_commit_ = *second;
    if (is_from_fork) {
      const auto fork = git({"merge-base", first_commit_, second_commit_});
      if (!fork) {
        error_ = fmt::format("`{}` and `{}` have no commit in common", shown, second_name);
        return;
      }
      first_commit_ = first_line(*fork);
      constexpr std::size_t kShortHash = 9;
      shown = first_commit_.substr(0, kShortHash);
    }
    second_ = unpack(second_commit_, second_name.empty() ? "HEAD" : second_name);
  }
  if (error_.empty()) {
    first_ = unpack(first_commit_, shown);
  }
}

std::vector<CircuitChange> GitRevisions::changed_circuits(const fs::path& folder) {
  std::vector<std::string> compared = {"diff", "--name-only", "-z", "--no-renames", first_commit_};
  if (second_) {
    compared.push_back(second_commit_);
  }
  const auto names = git(compared);
  // Those that are not committed are new.
  const auto untracked =
      second_ ? std::optional<std::string>("") : git({"ls-files", "-z", "--others", "--exclude-standard"});
  const auto before = git({"ls-tree", "-r", "--name-only", "-z", first_commit_});
  const auto after = second_ ? git({"ls-tree", "-r", "--name-only", "-z", second_commit_}) : git({"ls-files", "-z"});
  if (!names || !untracked || !before || !after) {
    return {};
  }
  std::set<std::string> differing, files;
  for (const std::string& name : split_at_zeros(*names + *untracked)) {
    differing.insert(name);
  }
  for (const std::string& name : split_at_zeros(*before + *after + *untracked)) {
    if (name.ends_with(".json") && is_within(fs::path(name).lexically_relative(folder.empty() ? "." : folder))) {
      files.insert(name);
    }
  }
  std::vector<CircuitChange> changes;
  References old_ones(first_->path()), new_ones(second_folder());
  for (const std::string& file : files) {
    const bool was = is_circuit_text(read_text(first_->path() / file));
    const bool is = is_circuit_text(read_text(second_folder() / file));
    if (!was && !is) {
      continue;
    }
    std::set<std::string> read = was ? old_ones.of(file) : std::set<std::string>{};
    read.merge(is ? new_ones.of(file) : std::set<std::string>{});
    bool differs = was != is;
    for (const std::string& name : read) {
      differs = differs || differing.count(name) > 0;
    }
    if (differs) {
      using Kind = CircuitChange::Kind;
      changes.push_back({was && is ? Kind::Changed : is ? Kind::New : Kind::Gone, file});
    }
  }
  return changes;
}

}  // namespace tectum
