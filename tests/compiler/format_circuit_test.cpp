// Layout of circuit files: what is kept, what is normalised, and what is refused.
#include "compiler/format/format_circuit.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "compiler/format/jsonc_tokens.h"

using namespace tectum;

namespace {

// Comments as text without blanks, in order: layout may move their indentation.
std::vector<std::string> comments_of(const std::string& text) {
  std::vector<std::string> comments;
  for (const JsoncToken& token : tokenize_jsonc(text).tokens) {
    if (token.kind != JsoncTokenKind::LineComment && token.kind != JsoncTokenKind::BlockComment) {
      continue;
    }
    std::string squeezed;
    for (const char c : token.text) {
      if (c != ' ' && c != '\t' && c != '\r') {
        squeezed += c;
      }
    }
    comments.push_back(squeezed);
  }
  return comments;
}

nlohmann::ordered_json json_of(const std::string& text) {
  return nlohmann::ordered_json::parse(text, nullptr, false, true);
}

// Formats and checks everything that must hold of any result.
std::string formatted(const std::string& text) {
  const FormattedCircuit once = format_circuit(text);
  REQUIRE(once.text);
  CHECK(json_of(*once.text) == json_of(text));
  CHECK(comments_of(*once.text) == comments_of(text));
  const FormattedCircuit twice = format_circuit(*once.text);
  REQUIRE(twice.text);
  CHECK(*twice.text == *once.text);
  return *once.text;
}

}  // namespace

TEST_CASE("layout of values") {
  struct Row {
    std::string input;
    std::string expected;
  };
  const Row rows[] = {
      {"3", "3\n"},
      {"{}", "{}\n"},
      {"[\n]", "[]\n"},
      {R"({"a":1,"b":[1,2 , 3]})", "{ \"a\": 1, \"b\": [1, 2, 3] }\n"},
      {"{\n\"a\":1}", "{\n  \"a\": 1\n}\n"},
      {"{\n\n\n\"a\":1,\n\n\n\n\"b\":2\n\n}", "{\n  \"a\": 1,\n\n  \"b\": 2\n}\n"},
      {"{\n\"a\":1, \"b\":2,\n\"c\":3}", "{\n  \"a\": 1, \"b\": 2,\n  \"c\": 3\n}\n"},
      {"{\n\"a\":\n\n{\"x\" :1}}", "{\n  \"a\": { \"x\": 1 }\n}\n"},
      {"[1\n,2]", "[\n  1,\n  2\n]\n"},
      {"\xef\xbb\xbf{}", "{}\n"},
      {"{\r\n \"a\": 1 // x \r\n}\r\n", "{\n  \"a\": 1  // x\n}\n"},
      {"{ \"a\": {\n\"b\": 1}, \"c\": 2 }", "{\n  \"a\": {\n    \"b\": 1\n  },\n  \"c\": 2\n}\n"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.input);
    CHECK(formatted(row.input) == row.expected);
  }
}

TEST_CASE("comments stay where they were") {
  struct Row {
    std::string input;
    std::string expected;
  };
  const Row rows[] = {
      {"// head\n\n{} // tail\n// end", "// head\n\n{}  // tail\n// end\n"},
      {"{ // open\n\"a\": 1, // of a\n// of b\n\"b\": 2 // last\n// dangling\n}",
       "{  // open\n  \"a\": 1,  // of a\n  // of b\n  \"b\": 2  // last\n  // dangling\n}\n"},
      {"[1, /* of two */ 2 /* after two */]", "[1, /* of two */ 2 /* after two */]\n"},
      {"[ /* nothing */ ]", "[ /* nothing */ ]\n"},
      {"[ // nothing\n]", "[  // nothing\n]\n"},
      {"[\n// nothing\n]", "[\n  // nothing\n]\n"},
      {"{\"a\" /* k */ : /* v */ 1}", "{ \"a\": /* k */ /* v */ 1 }\n"},
      {"{\"a\": // why\n 1}", "{\n  // why\n  \"a\": 1\n}\n"},
      {"[1 // one\n, 2]", "[\n  1,  // one\n  2\n]\n"},
      {"[1\n// below\n, // behind\n 2]", "[\n  1,\n  // below\n  // behind\n  2\n]\n"},
      {"{\n      /* a\n       * b\n       */\n\"x\": 1}", "{\n  /* a\n   * b\n   */\n  \"x\": 1\n}\n"},
      {"{\n/* free\n      text */\n\"x\": 1}", "{\n  /* free\n      text */\n  \"x\": 1\n}\n"},
      {"[1 /* a\n b */, 2]", "[\n  1 /* a\n b */,\n  2\n]\n"},
      {"{\n\"a\": 1,\n\n// para\n\n\"b\": 2}", "{\n  \"a\": 1,\n\n  // para\n\n  \"b\": 2\n}\n"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.input);
    CHECK(formatted(row.input) == row.expected);
  }
}

TEST_CASE("a line that is too long is broken: objects of objects an entry a line, others filled") {
  std::string numbers = "[";
  std::string members = "{";
  std::string objects = "{";
  for (int i = 0; i < 60; ++i) {
    numbers += (i ? "," : "") + std::to_string(1000 + i);
    objects += (i ? ",\"o" : "\"o") + std::to_string(i) + "\":{\"k\":1}";
    members += (i ? ",\"k" : "\"k") + std::to_string(i) + "\":" + std::to_string(i);
  }
  const std::string array = formatted(numbers + "]");
  CHECK(array.substr(0, 10) == "[\n  1000, ");
  CHECK(std::count(array.begin(), array.end(), '\n') == 6);
  for (std::size_t begin = 0; begin < array.size(); begin = array.find('\n', begin) + 1) {
    CHECK(array.find('\n', begin) - begin <= 120);
  }
  const std::string object = formatted(members + "}");
  CHECK(std::count(object.begin(), object.end(), '\n') == 8);
  CHECK(formatted(object) == object);
  const std::string nested = formatted(objects + "}");
  CHECK(std::count(nested.begin(), nested.end(), '\n') == 62);
}

TEST_CASE("exactly 120 columns fit") {
  const std::string at_limit = "[\"" + std::string(115, 'x') + "\"]";  // 119 and the comma that may follow
  CHECK(formatted(at_limit) == at_limit + "\n");
  CHECK(formatted("[\"" + std::string(116, 'x') + "\"]").front() == '[');
  CHECK(formatted("[\"" + std::string(116, 'x') + "\"]")[1] == '\n');
}

TEST_CASE("what is no JSON with comments is refused with its place") {
  struct Row {
    std::string text;
    std::size_t offset;
    std::string error;
  };
  const Row rows[] = {
      {"", 0, "expected a value, the file ends here"},
      {"{", 0, "bracket is never closed"},
      {"[1, 2", 0, "bracket is never closed"},
      {"[1, ]", 4, "comma before a closing bracket"},
      {"[1 2]", 3, "expected `,` or a closing bracket"},
      {"{a: 1}", 1, "expected a value, a bracket or a comment"},
      {"{1: 1}", 1, "expected a key in double quotes"},
      {"{\"a\" 1}", 5, "expected `:` after the key"},
      {"{\"a\": }", 6, "expected a value"},
      {"{} {}", 3, "expected the end of the file"},
      {"[01]", 1, "malformed number"},
      {"[-]", 1, "malformed number"},
      {"[1.]", 1, "malformed number"},
      {"[\"a]", 1, "string is never closed"},
      {"[\"a\n\"]", 3, "string is not closed on its line"},
      {"[\"\\x\"]", 2, "broken escape in a string"},
      {"[\"\\ud800\"]", 2, "broken escape in a string"},
      {"[\"\xff\"]", 2, "text is not UTF-8"},
      {"[\"\x01\"]", 2, "control character in a string"},
      {"/* open", 0, "comment is never closed"},
      {"/ 1", 0, "expected a comment after `/`"},
      {std::string(300, '['), 256, "nested deeper than 256 levels"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.text);
    const FormattedCircuit result = format_circuit(row.text);
    CHECK_FALSE(result.text);
    CHECK(result.error == row.error);
    CHECK(result.error_offset == row.offset);
  }
}

TEST_CASE("random documents: idempotent, same JSON, same comments, and refused exactly when a JSON parser refuses") {
  // Pieces glued at random; about a third of the documents are well formed because brackets are closed.
  const char* pieces[] = {"1",    "\"s\"",  "{",        "}",    "[",      "]",       ",",
                          ":",    " ",      "\n",       "\n\n", "// c\n", "/* d */", "/* e\n f */",
                          "true", "\"k\":", "\"k\": 1", ", ",   "{}",     "[]",      "/* g\n * h\n */",
                          ",\n"};
  std::mt19937 random(20240607);  // fixed: a failure repeats
  int accepted = 0;
  for (int round = 0; round < 60000; ++round) {
    std::string text;
    std::string closing;
    const std::size_t length = random() % 14;
    for (std::size_t i = 0; i < length; ++i) {
      const std::string piece = pieces[random() % std::size(pieces)];
      text += piece;
      if (piece == "{" || piece == "[") {
        closing.insert(0, piece == "{" ? "}" : "]");
      }
      if ((piece == "}" || piece == "]") && !closing.empty()) {
        closing.erase(0, 1);
      }
    }
    text += closing;
    CAPTURE(text);
    const FormattedCircuit once = format_circuit(text);
    REQUIRE(once.text.has_value() == !json_of(text).is_discarded());
    if (!once.text) {
      continue;
    }
    ++accepted;
    REQUIRE(json_of(*once.text) == json_of(text));
    REQUIRE(comments_of(*once.text) == comments_of(text));
    REQUIRE(format_circuit(*once.text).text == once.text);
  }
  CHECK(accepted > 2000);
}
