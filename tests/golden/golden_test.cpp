// Golden cases: one file each, with the command, its input files and everything it prints.
//
//   # why the case exists
//   run: tectum check circuit.json        (several lines run one after the other)
//   setup: tectum run circuit.json        what a case starts from; what it prints is not kept
//   exit: 1                               (of the last)
//   --- circuit.json                      an input file, written to a fresh directory
//   --- stdout                            expected, absent when empty
//   --- stderr
//
// UPDATE_GOLDEN=1 rewrites exit, stdout and stderr; read the difference like code. A case that fails starts with bad-.
#include <doctest/doctest.h>
#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "compiler/diagnostics/diagnostic.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;

const fs::path kGoldenDir = fs::path(TECTUM_SOURCE_DIR) / "tests" / "golden";

struct GoldenCase {
  std::string head;  // comment, setup and run lines
  std::vector<std::string> setups;
  std::vector<std::string> runs;
  int exit_status = 0;
  std::vector<std::pair<std::string, std::string>> inputs;
  std::string out;
  std::string err;
};

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

GoldenCase parse_case(const std::string& text) {
  GoldenCase parsed;
  std::istringstream lines(text);
  std::string line;
  std::string* part = nullptr;
  while (std::getline(lines, line)) {
    if (line.rfind("--- ", 0) == 0) {
      const std::string name = line.substr(4);
      if (name == "stdout" || name == "stderr") {
        part = name == "stdout" ? &parsed.out : &parsed.err;
      } else {
        part = &parsed.inputs.emplace_back(name, "").second;
      }
    } else if (part != nullptr) {
      *part += line + "\n";
    } else if (line.rfind("exit: ", 0) == 0) {
      parsed.exit_status = std::stoi(line.substr(6));
    } else {
      parsed.head += line + "\n";
      if (line.rfind("run: tectum ", 0) == 0) {
        parsed.runs.push_back(line.substr(12));
      } else if (line.rfind("setup: tectum ", 0) == 0) {
        parsed.setups.push_back(line.substr(14));
      }
    }
  }
  return parsed;
}

std::string print_case(const GoldenCase& golden) {
  std::string text = golden.head + "exit: " + std::to_string(golden.exit_status) + "\n";
  for (const auto& [name, content] : golden.inputs) {
    text += "--- " + name + "\n" + content;
  }
  text += golden.out.empty() ? "" : "--- stdout\n" + golden.out;
  return text + (golden.err.empty() ? "" : "--- stderr\n" + golden.err);
}

/// Words at blanks; single quotes keep blanks together.
std::vector<std::string> split_words(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  bool is_quoted = false;
  bool is_open = false;
  for (const char c : text) {
    if (c == '\'') {
      is_quoted = !is_quoted;
      is_open = true;
    } else if (c == ' ' && !is_quoted) {
      if (is_open) {
        words.push_back(std::exchange(word, ""));
      }
      is_open = false;
    } else {
      word += c;
      is_open = true;
    }
  }
  if (is_open) {
    words.push_back(word);
  }
  return words;
}

/// Runs the case in a fresh directory, which is also the current one.
GoldenCase run_case(GoldenCase golden) {
  std::string pattern = (fs::temp_directory_path() / "tectum-golden-XXXXXX").string();
  const fs::path dir = mkdtemp(pattern.data());
  const fs::path back = fs::current_path();
  for (const auto& [name, content] : golden.inputs) {
    fs::create_directories((dir / name).parent_path());
    std::ofstream(dir / name, std::ios::binary) << content;
  }
  fs::current_path(dir);
  std::ostringstream out;
  std::ostringstream err;
  for (const std::string& setup : golden.setups) {
    std::ostringstream unkept;
    REQUIRE_MESSAGE(tectum_main(split_words(setup), unkept, unkept) == 0, setup, ": ", unkept.str());
  }
  for (const std::string& run : golden.runs) {
    golden.exit_status = tectum_main(split_words(run), out, err);
  }
  fs::current_path(back);
  fs::remove_all(dir);
  golden.out = out.str();
  golden.err = err.str();
  const auto end_line = [](std::string& text) { text += text.empty() || text.back() == '\n' ? "" : "\n"; };
  end_line(golden.out);
  end_line(golden.err);
  return golden;
}

std::vector<fs::path> all_cases() {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(kGoldenDir)) {
    if (entry.path().extension() == ".case") {
      paths.push_back(entry.path());
    }
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST_CASE("every golden case prints what it printed before") {
  const char* update = getenv("UPDATE_GOLDEN");
  const bool updates = update != nullptr && std::string(update) == "1";
  for (const fs::path& path : all_cases()) {
    CAPTURE(path.lexically_relative(kGoldenDir).string());
    const std::string text = read_text(path);
    const GoldenCase expected = parse_case(text);
    REQUIRE_FALSE(expected.runs.empty());
    const GoldenCase actual = run_case(expected);
    if (updates) {
      if (print_case(actual) != text) {
        std::ofstream(path, std::ios::binary) << print_case(actual);
      }
      continue;
    }
    CHECK(actual.exit_status == expected.exit_status);
    CHECK(actual.out == expected.out);
    CHECK(actual.err == expected.err);
  }
}

TEST_CASE("a case is called bad- if and only if it fails") {
  for (const fs::path& path : all_cases()) {
    CAPTURE(path.lexically_relative(kGoldenDir).string());
    const bool is_called_bad = path.filename().string().rfind("bad-", 0) == 0;
    CHECK(is_called_bad == (parse_case(read_text(path)).exit_status != 0));
  }
}

TEST_CASE("every diagnostic code has a golden case that prints it") {
  std::string printed;
  for (const fs::path& path : all_cases()) {
    const GoldenCase golden = parse_case(read_text(path));
    printed += golden.err + golden.out;
  }
  for (std::size_t i = 0; i < code_count(); ++i) {
    const std::string label = code_label(static_cast<Code>(i));
    CAPTURE(label);
    CHECK(printed.find("[" + label + "]") != std::string::npos);
  }
}

}  // namespace
}  // namespace tectum
