#include "tools/tectum/diff_git.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tools/git/git_revisions.h"
#include "tools/git/run_process.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;

int trouble(CommandContext& context, const std::string& what) {
  context.err << "tectum: " << what << '\n';
  return kExitTrouble;
}

const char* word_for(CircuitChange::Kind kind) {
  switch (kind) {
    case CircuitChange::Kind::New:
      return "new";
    case CircuitChange::Kind::Gone:
      return "gone";
    case CircuitChange::Kind::Changed:
      break;
  }
  return "changed";
}

/// out/diff.html becomes out/diff-oculomotor.html.
std::string page_of(const std::string& path, const std::string& circuit) {
  fs::path page = path;
  page.replace_filename(
      fmt::format("{}-{}{}", page.stem().string(), fs::path(circuit).stem().string(), page.extension().string()));
  return page.string();
}

class RevisionDiff {
 public:
  RevisionDiff(const DiffArguments& arguments, const BatteryPlan& plan, GitRevisions& revisions,
               CommandContext& context)
      : arguments_(arguments), plan_(plan), revisions_(revisions), context_(context) {}

  int one(const std::string& file) {
    std::error_code ignored;
    if (!fs::exists(revisions_.first().path() / file, ignored)) {
      return trouble(context_, revisions_.first().named(
                                   fmt::format("{} does not exist at {}", file, revisions_.first().path().string())));
    }
    if (!fs::exists(revisions_.second_folder() / file, ignored)) {
      return trouble(context_, fmt::format("{} is gone", file));
    }
    add({CircuitChange::Kind::Changed, file}, arguments_);
    return finish(false);
  }

  int all(const std::vector<CircuitChange>& changes) {
    for (const CircuitChange& change : changes) {
      DiffArguments arguments = arguments_;
      arguments.a = change.file;
      if (!arguments.report_path.empty() && changes.size() > 1) {
        arguments.report_path = page_of(arguments.report_path, change.file);
      }
      add(change, arguments);
    }
    return finish(true);
  }

 private:
  void add(const CircuitChange& change, const DiffArguments& arguments) {
    PairDiff pair;
    if (change.kind == CircuitChange::Kind::Changed) {
      const auto named = [&](std::string text) {
        text = revisions_.first().named(std::move(text));
        return revisions_.second() != nullptr ? revisions_.second()->named(std::move(text)) : text;
      };
      const fs::path now = revisions_.second_folder() / change.file;
      std::error_code ignored;
      const fs::path shown = revisions_.second() != nullptr ? now : fs::proximate(now, ignored);
      pair = diff_pair(arguments, plan_, (revisions_.first().path() / change.file).string(), shown.string(), named,
                       context_);
    } else {
      pair.exit_status = arguments_.tolerates_spread ? kExitOk : kExitFailed;
    }
    status_ = std::max(status_, pair.exit_status);
    text_ += fmt::format("{}== {}: {}\n{}", text_.empty() ? "" : "\n", change.file, word_for(change.kind), pair.text);
    nlohmann::ordered_json entry = {{"file", change.file}, {"what", word_for(change.kind)}};
    if (arguments_.format == "json" && !pair.text.empty()) {
      entry["diff"] = nlohmann::ordered_json::parse(pair.text, nullptr, false);
    }
    files_.push_back(entry);
    alone_ = pair.text;
  }

  int finish(bool is_list) {
    if (arguments_.format == "json") {
      context_.out << nlohmann::ordered_json{{"revisions", arguments_.revisions}, {"files", files_}}.dump(2) << '\n';
    } else if (is_list) {
      context_.out << (text_.empty() ? fmt::format("no circuit has changed since {}\n", arguments_.revisions) : text_);
    } else {
      context_.out << alone_;
    }
    return status_;
  }

  const DiffArguments& arguments_;
  const BatteryPlan& plan_;
  GitRevisions& revisions_;
  CommandContext& context_;
  int status_ = kExitOk;
  std::string text_, alone_;
  nlohmann::ordered_json files_ = nlohmann::ordered_json::array();
};

/// `content` as `path` among links to the files that lie beside `path` and its folders, so that what it refers to is
/// found. Returns where it lies now.
fs::path put_beside_neighbours(const fs::path& folder, const fs::path& path, const fs::path& content) {
  std::error_code ignored;
  fs::path here = fs::current_path(ignored), there = folder;
  fs::create_directories(there, ignored);
  for (const fs::path& part : path) {
    for (const fs::directory_entry& entry : fs::directory_iterator(here, ignored)) {
      if (entry.path().filename() != part && entry.path().filename() != ".git") {
        fs::create_symlink(entry.path(), there / entry.path().filename(), ignored);
      }
    }
    here /= part;
    there /= part;
    if (part != *std::prev(path.end())) {
      fs::create_directories(there, ignored);
    }
  }
  fs::copy_file(content, there, ignored);
  return there;
}

bool is_circuit_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return is_circuit_text(text.str());
}

}  // namespace

int diff_revisions(const DiffArguments& arguments, const BatteryPlan& plan, CommandContext& context) {
  std::error_code ignored;
  const fs::path file = arguments.a.empty() ? fs::path() : fs::weakly_canonical(arguments.a, ignored);
  const fs::path place = file.empty() ? fs::current_path(ignored) : file.parent_path();
  if (!fs::is_directory(place, ignored)) {
    return trouble(context, fmt::format("{} is no folder", place.string()));
  }
  GitRevisions revisions(arguments.revisions, place);
  if (!revisions.error().empty()) {
    return trouble(context, revisions.error());
  }
  RevisionDiff diff(arguments, plan, revisions, context);
  if (!file.empty()) {
    return diff.one(file.lexically_relative(revisions.root()).generic_string());
  }
  const fs::path below = fs::canonical(place, ignored).lexically_relative(revisions.root());
  const std::vector<CircuitChange> changes = revisions.changed_circuits(below);
  return revisions.error().empty() ? diff.all(changes) : trouble(context, revisions.error());
}

int diff_for_git(DiffArguments arguments, const std::vector<std::string>& from_git, CommandContext& context) {
  constexpr std::size_t kFewest = 7, kOld = 1, kNew = 4;
  if (from_git.size() == 1) {
    context.out << fmt::format("* unmerged: {}\n", from_git[0]);
    return kExitOk;
  }
  if (from_git.size() < kFewest) {
    return trouble(context, "--git-driver is for git: set diff.tectum.command to `tectum diff --git-driver`");
  }
  const std::string& path = from_git[0];
  if (!is_circuit_file(from_git[kOld]) || !is_circuit_file(from_git[kNew])) {
    context.out
        << run_process({"git", "diff", "--no-index", "--no-ext-diff", "--", from_git[kOld], from_git[kNew]}).out;
    return kExitOk;
  }
  const TemporaryFolder folder;
  const std::string root = folder.path().string();
  const fs::path a = put_beside_neighbours(folder.path() / "a", path, from_git[kOld]);
  const fs::path b = put_beside_neighbours(folder.path() / "b", path, from_git[kNew]);
  const auto named = [&](std::string text) {
    for (std::size_t at = text.find(root + "/"); at != std::string::npos; at = text.find(root + "/", at)) {
      text.erase(at, root.size() + 1);
    }
    return text;
  };
  arguments.a = "a/" + path;
  arguments.b = "b/" + path;
  const PairDiff pair = diff_pair(arguments, BatteryPlan{}, a.string(), b.string(), named, context);
  context.out << fmt::format("tectum diff a/{} b/{}\n{}", path, path, pair.text);
  return kExitOk;
}

}  // namespace tectum
