#include "tools/tectum/usage_error.h"

#include <fmt/format.h>

#include <algorithm>

#include "compiler/expression/expression.h"

namespace tectum {
namespace {

/// Down to the innermost command that was given: "tectum servo scan".
std::string command_path(const CLI::App& app, const CLI::App*& innermost) {
  std::string path = app.get_name();
  innermost = &app;
  for (auto chosen = app.get_subcommands(); !chosen.empty(); chosen = innermost->get_subcommands()) {
    innermost = chosen.front();
    path += " " + innermost->get_name();
  }
  return path;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      names.push_back("--" + name);
    }
  }
  return names;
}

std::string first_line(std::string text) {
  text.erase(std::min(text.find('\n'), text.size()));
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) {
    text.pop_back();
  }
  return text;
}

std::string hint(const std::string& path, const std::optional<std::string>& nearest) {
  std::string text = nearest ? fmt::format("    = help: did you mean `{}`?\n", *nearest) : "";
  return text + fmt::format("    = help: `{} --help` lists what there is\n", path);
}

}  // namespace

std::optional<std::string> unknown_command(const CLI::App& app, const std::vector<std::string>& args) {
  if (args.empty() || args.front().empty() || args.front().front() == '-') {
    return std::nullopt;
  }
  const std::vector<std::string> names = command_names(app);
  if (std::find(names.begin(), names.end(), args.front()) != names.end()) {
    return std::nullopt;
  }
  return fmt::format("{}: unknown command `{}`\n", app.get_name(), args.front()) +
         hint(app.get_name(), nearest_name(args.front(), names));
}

std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = nullptr;
  const std::string path = command_path(app, command);
  if (const auto* extras = dynamic_cast<const CLI::ExtrasError*>(&error)) {
    // The library says "The following argument was not expected: --lesoin".
    const std::string text = first_line(extras->what());
    const std::size_t colon = text.rfind(": ");
    const std::string argument = colon == std::string::npos ? text : text.substr(colon + 2);
    // ... and lists what is left over from the end; an option's value goes with it.
    const std::size_t dash = argument.find(" -") == std::string::npos ? 0 : argument.find(" -") + 1;
    const std::string first = argument.substr(dash, argument.find(' ', dash) - dash);
    const bool is_option = !first.empty() && first.front() == '-';
    return fmt::format("{}: {} `{}`\n", path, is_option ? "unknown option" : "does not take",
                       is_option ? first : argument) +
           hint(path,
                is_option ? nearest_name(first.substr(0, first.find('=')), option_names(*command)) : std::nullopt);
  }
  return fmt::format("{}: {}\n", path, first_line(error.what())) + hint(path, std::nullopt);
}

}  // namespace tectum
