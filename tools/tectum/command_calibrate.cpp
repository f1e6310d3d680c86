// tectum calibrate: measured places on a wall to a head file's joints.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "compiler/source/source_file.h"
#include "tools/live/calibration.h"
#include "tools/live/head_file.h"
#include "tools/tectum/command.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

struct CalibrateArguments {
  std::string data_path;
  CalibrationOptions options;
  std::string head_path, out_path, picture_path;
  std::string format = "text";
};

void fail(CommandContext& context, const std::string& line) {
  context.err << fmt::format("tectum: {}\n", line);
  context.exit_status = kExitTrouble;
}

std::string table(const std::vector<CalibrationData>& data, const std::vector<CalibrationFit>& fits) {
  std::string text = fmt::format("{:<16} {:>6} {:>10} {:>7} {:>10} {:>10}   leave-one-out RMSE (deg) by degree\n",
                                 "joint", "places", "deg/unit", "degree", "RMSE (deg)", "most (deg)");
  for (std::size_t i = 0; i < data.size(); ++i) {
    const CalibrationFit& fit = fits[i];
    text += fmt::format("{:<16} {:>6} {:>+10.5f} {:>7} {:>10.3f} {:>10.3f}  ", data[i].joint, data[i].points.size(),
                        fit.deg_per_unit(), fit.degree(), fit.rmse_deg, fit.largest_deg);
    for (const double cross_deg : fit.cross_rmse_deg) {
      text += fmt::format(" {:.3f}", cross_deg);
    }
    text += '\n';
  }
  text += "\nangle (deg) = c0 + c1 x + c2 x^2 + ..., x = (position - centre) / 100\n";
  for (std::size_t i = 0; i < data.size(); ++i) {
    text += fmt::format("{:<16} centre {:>3}:", data[i].joint, fits[i].centre_units);
    for (const double c : fits[i].coefficients_deg) {
      text += fmt::format(" {:>+12.6f}", c);
    }
    text += '\n';
  }
  return text;
}

std::string json(const std::vector<CalibrationData>& data, const std::vector<CalibrationFit>& fits) {
  nlohmann::ordered_json joints = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < data.size(); ++i) {
    joints.push_back({{"joint", data[i].joint},
                      {"places", data[i].points.size()},
                      {"centre_units", fits[i].centre_units},
                      {"degree", fits[i].degree()},
                      {"deg_per_unit", fits[i].deg_per_unit()},
                      {"coefficients_deg", fits[i].coefficients_deg},
                      {"rmse_deg", fits[i].rmse_deg},
                      {"largest_deg", fits[i].largest_deg},
                      {"leave_one_out_rmse_deg", fits[i].cross_rmse_deg},
                      {"residuals_deg", fits[i].residuals_deg}});
  }
  return nlohmann::ordered_json{{"joints", joints}}.dump(2, ' ', false,
                                                         nlohmann::ordered_json::error_handler_t::replace);
}

bool write_file(const std::string& path, const std::string& text, CommandContext& context) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) {
    fail(context, fmt::format("cannot write {}", path));
    return false;
  }
  context.err << fmt::format("wrote {}\n", path);
  return true;
}

void write_head(const CalibrateArguments& arguments, const std::vector<CalibrationData>& data,
                const std::vector<CalibrationFit>& fits, CommandContext& context) {
  const ReadSource source = read_source(arguments.head_path);
  if (!source.ok) {
    fail(context, source.error);
    return;
  }
  ReadHead read = read_head_text(source.file.name, source.file.bytes);
  context.err << read.problems;
  if (!read.head) {
    context.exit_status = kExitTrouble;
    return;
  }
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto* const name = std::find(kHeadJointNames.begin(), kHeadJointNames.end(), data[i].joint);
    const auto j = static_cast<std::size_t>(name - kHeadJointNames.begin());
    if (name == kHeadJointNames.end() || !read.head->map.joints[j].is_present) {
      context.err << fmt::format("{} is not in {}: left out\n", data[i].joint, arguments.head_path);
      continue;
    }
    apply_calibration(fits[i], data[i], read.head->map.joints[j]);
  }
  const std::optional<std::string> text = with_joints(source.file.bytes, read.head->map, read.head->neutral_deg);
  if (!text) {
    fail(context, fmt::format("{} has no joints to put the calibration into", arguments.head_path));
    return;
  }
  const ReadHead check = read_head_text(arguments.out_path, *text);
  if (!check.head) {
    context.err << check.problems;
    fail(context, "the calibration does not make a head file");
    return;
  }
  (void)write_file(arguments.out_path, *text, context);
}

void calibrate(const CalibrateArguments& arguments, CommandContext& context) {
  if (arguments.out_path.empty() != arguments.head_path.empty()) {
    context.err << "tectum: --head and --out go together: the head file to start from, and the one to write\n";
    context.exit_status = kExitUsage;
    return;
  }
  const ReadCalibration read = read_calibration(arguments.data_path, arguments.options);
  if (!read.error.empty()) {
    fail(context, read.error);
    return;
  }
  std::vector<CalibrationFit> fits;
  for (const CalibrationData& joint : read.joints) {
    std::string error;
    fits.push_back(fit_calibration(joint, arguments.options, error));
    if (!error.empty()) {
      fail(context, error);
      return;
    }
  }
  context.out << (arguments.format == "json" ? json(read.joints, fits) + "\n" : table(read.joints, fits));
  if (!arguments.picture_path.empty()) {
    (void)write_file(arguments.picture_path, calibration_svg(read.joints, fits), context);
  }
  if (!arguments.out_path.empty()) {
    write_head(arguments, read.joints, fits, context);
  }
}

}  // namespace

void add_calibrate_command(CLI::App& app, CommandContext& context) {
  CLI::App* command = app.add_subcommand("calibrate", "fit servo positions to measured angles");
  auto arguments = std::make_shared<CalibrateArguments>();
  command
      ->add_option("data", arguments->data_path,
                   "CSV with columns joint, servo_position, and angle_deg or wall_distance_cm [and offset_added_cm]")
      ->required()
      ->type_name("DATA.csv");
  command->add_option("--distance", arguments->options.wall_distance_cm, "from the joints' axes to the wall")
      ->check(CLI::Range(1.0, 1e4))
      ->capture_default_str()
      ->type_name("CM");
  command
      ->add_option("--eye-half-baseline", arguments->options.eye_half_baseline_cm,
                   "eyes this far left and right of the wall's zero [angles are seen from the middle]")
      ->check(CLI::Range(0.0, 100.0))
      ->type_name("CM");
  command->add_option("--degree", arguments->options.degree, "of the polynomial [by cross-validation]")
      ->check(CLI::Range(1, kHighestDegree));
  command->add_option("--picture", arguments->picture_path, "draw fits and residuals as SVG")->type_name("FILE");
  command->add_option("--head", arguments->head_path, "head file whose joints to calibrate")->type_name("FILE");
  command->add_option("-o,--out", arguments->out_path, "with --head: write the calibrated head file")
      ->type_name("FILE");
  command->add_option("--format", arguments->format, "what to print: text or json")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
  command->footer(
      "Turn one joint at a time, note its servo's position and where its laser or its eye's cross falls on the wall.\n"
      "Six places a joint and more; twelve show the bend.\n\n"
      "Examples:\n"
      "  tectum calibrate servo_calibration.csv --picture fit.svg\n"
      "  tectum calibrate mine.csv --distance 60 --head circuits/heads/head2020.json --out my_head.json\n");
  command->callback([arguments, &context] { calibrate(*arguments, context); });
}

}  // namespace tectum
