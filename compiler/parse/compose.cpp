#include "compiler/parse/compose.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_json.h"

namespace tectum {
namespace {

/// A tree that can be taken apart and put together.
struct Branch {
  JsonNode node;
  std::vector<Branch> children;
};

Branch grow(const JsonTree& tree, JsonId id) {
  Branch branch{tree[id], {}};
  for (JsonId child = tree[id].first_child; child != JsonId::None; child = tree[child].next_sibling) {
    branch.children.push_back(grow(tree, child));
  }
  return branch;
}

JsonId lay_down(const Branch& branch, JsonTree& tree) {
  const auto id = static_cast<JsonId>(tree.nodes.size());
  tree.nodes.push_back(branch.node);
  tree[id].first_child = JsonId::None;
  tree[id].next_sibling = JsonId::None;
  tree[id].child_count = static_cast<std::uint32_t>(branch.children.size());
  JsonId last = JsonId::None;
  for (const Branch& child : branch.children) {
    const JsonId made = lay_down(child, tree);
    (last == JsonId::None ? tree[id].first_child : tree[last].next_sibling) = made;
    last = made;
  }
  return id;
}

Branch* find_child(Branch& branch, const std::string& key) {
  const auto found = std::find_if(branch.children.begin(), branch.children.end(),
                                  [&](const Branch& child) { return child.node.key == key; });
  return found == branch.children.end() ? nullptr : &*found;
}

std::optional<Branch> take_child(Branch& branch, const std::string& key) {
  const auto found = std::find_if(branch.children.begin(), branch.children.end(),
                                  [&](const Branch& child) { return child.node.key == key; });
  if (found == branch.children.end()) {
    return std::nullopt;
  }
  Branch taken = std::move(*found);
  branch.children.erase(found);
  return taken;
}

/// `over`'s members replace `base`'s, object by object; null removes. The result stands where `over` stands.
void overlay(Branch& base, Branch over) {
  if (base.node.kind != JsonKind::Object || over.node.kind != JsonKind::Object) {
    base = std::move(over);
    return;
  }
  base.node.span = over.node.span;
  base.node.key_span = over.node.key_span;
  for (Branch& child : over.children) {
    Branch* same = find_child(base, child.node.key);
    if (same == nullptr) {
      base.children.push_back(std::move(child));
    } else if (child.node.kind == JsonKind::Null) {
      static_cast<void>(take_child(base, child.node.key));
    } else {
      overlay(*same, std::move(child));
    }
  }
}

class Composer {
 public:
  Composer(const SourceReader& read, Sources& sources, Diagnostics& diagnostics)
      : read_(read), sources_(sources), diagnostics_(diagnostics) {}

  [[nodiscard]] bool is_whole() const { return is_whole_; }

  Branch compose(Branch own, FileId file) {
    open_.push_back(sources_.file(file).name);
    const std::optional<Branch> extends = take_child(own, "extends");
    const std::optional<Branch> include = take_child(own, "include");
    if (include) {
      for (const Branch* name : names_in(*include, "include")) {
        auto included = load(*name);
        if (included) {
          join(own, std::move(*included));
        }
      }
    }
    if (extends) {
      for (const Branch* name : names_in(*extends, "extends")) {
        auto base = load(*name);
        if (base) {
          overlay(*base, std::move(own));
          own = std::move(*base);
        }
      }
    }
    open_.pop_back();
    return own;
  }

 private:
  std::vector<const Branch*> names_in(const Branch& value, const char* key) {
    std::vector<const Branch*> names;
    if (value.node.kind == JsonKind::String) {
      names.push_back(&value);
    }
    for (const Branch& child : value.children) {
      if (value.node.kind == JsonKind::Array && child.node.kind == JsonKind::String) {
        names.push_back(&child);
      }
    }
    const bool is_list = value.node.kind == JsonKind::Array && names.size() == value.children.size();
    if (value.node.kind != JsonKind::String && !(is_list && std::string(key) == "include")) {
      is_whole_ = false;
      diagnostics_.add(Code::WrongType, value.node.span,
                       {"`" + std::string(key) + "`", std::string(kind_phrase(value.node.kind)), "a file name"});
    }
    return names;
  }

  std::optional<Branch> load(const Branch& name) {
    const std::string path = resolve_path(sources_.file(name.node.span.file).name, name.node.text);
    const Span span = inner_span(name.node);
    if (std::find(open_.begin(), open_.end(), path) != open_.end()) {
      is_whole_ = false;
      diagnostics_.add(Code::IncludeCycle, span, {name.node.text});
      return std::nullopt;
    }
    ReadSource source = sources_.size() < kMaxComposedFiles ? read_(path) : ReadSource{};
    if (!source.ok) {
      is_whole_ = false;
      diagnostics_.add(Code::UnreadableFile, span,
                       {source.error.empty() ? "too many files are included" : source.error});
      return std::nullopt;
    }
    source.file.name = path;
    const FileId file = sources_.add(std::move(source.file));
    const auto tree = parse_json(sources_, file, diagnostics_);
    if (!tree) {
      is_whole_ = false;
      return std::nullopt;
    }
    if ((*tree)[tree->root()].kind != JsonKind::Object) {
      is_whole_ = false;
      diagnostics_.add(Code::WrongType, (*tree)[tree->root()].span,
                       {"the circuit", std::string(kind_phrase((*tree)[tree->root()].kind)), "an object"});
      return std::nullopt;
    }
    return compose(grow(*tree, tree->root()), file);
  }

  /// Sections come together; what else a file says of itself (name, tick, seed) counts only where it is missing.
  void join(Branch& own, Branch included) {
    for (Branch& section : included.children) {
      Branch* same = find_child(own, section.node.key);
      if (same == nullptr) {
        own.children.push_back(std::move(section));
      } else if (same->node.kind == JsonKind::Object && section.node.kind == JsonKind::Object) {
        for (Branch& member : section.children) {
          if (const Branch* clash = find_child(*same, member.node.key)) {
            diagnostics_.add(Code::NameClash, clash->node.key_span, {member.node.key})
                .label(member.node.key_span, "included from here");
            static_cast<void>(take_child(*same, member.node.key));  // nobody knows which of them is meant
            is_whole_ = false;
          } else {
            same->children.push_back(std::move(member));
          }
        }
      }
    }
  }

  const SourceReader& read_;
  Sources& sources_;
  Diagnostics& diagnostics_;
  std::vector<std::string> open_;  // files on the way from the circuit to here
  bool is_whole_ = true;           // every file could be read
};

}  // namespace

std::string resolve_path(const std::string& from, const std::string& path) {
  const std::filesystem::path given(path);
  if (given.is_absolute()) {
    return given.lexically_normal().string();
  }
  return (std::filesystem::path(from).parent_path() / given).lexically_normal().string();
}

JsonTree compose(JsonTree tree, FileId file, const SourceReader& read, Sources& sources, Diagnostics& diagnostics) {
  const bool is_alone =
      tree[tree.root()].kind != JsonKind::Object ||
      (tree.find(tree.root(), "include") == JsonId::None && tree.find(tree.root(), "extends") == JsonId::None);
  if (is_alone) {
    return tree;
  }
  Composer composer(read, sources, diagnostics);
  const Branch composed = composer.compose(grow(tree, tree.root()), file);
  JsonTree whole;
  whole.is_whole = composer.is_whole();
  static_cast<void>(lay_down(composed, whole));
  return whole;
}

}  // namespace tectum
