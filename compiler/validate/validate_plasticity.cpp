// How a projection learns: its reward, its quantities and bounds, and the factors that were learned before.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "compiler/validate/plasticity_keys.h"
#include "compiler/validate/validation.h"

namespace tectum {
namespace {

/// A factor s is at most this; the image has 31 bits for it.
constexpr double kHighestFactor = 7;
constexpr double kHighestRateHz = 1e6;
constexpr double kLongestTauMs = 1e7;

class PlasticityValidator {
 public:
  PlasticityValidator(Validation& v, const PlasticityDecl& decl) : v_(v), decl_(decl) {}

  std::optional<Plasticity> run(const std::string& target, const std::vector<std::string>& known_sides) {
    if (decl_.is_poisoned) {
      v_.scope.keep_silent();
      return std::nullopt;
    }
    const std::size_t before = v_.scope.trouble_count();
    v_.check_cites(decl_.provenance);
    form();
    for (const RewardUseDecl& use : decl_.rewards) {
      reward(use, target, known_sides);
    }
    numbers();
    bounds();
    for (const KeyedValue& learned : decl_.learned) {
      factors(learned);
    }
    const bool is_sound = v_.scope.trouble_count() == before && !decl_.rewards.empty();
    return is_sound ? std::optional(std::move(made_)) : std::nullopt;
  }

 private:
  template <typename Names>
  static std::vector<std::string> listed(const Names& names) {
    return {names.begin(), names.end()};
  }

  /// The place of `name` in `names`, reported when it has none.
  std::optional<std::size_t> find(const NameDecl& name, const std::vector<std::string>& names, const char* what) {
    const auto found = std::find(names.begin(), names.end(), name.text);
    if (found != names.end()) {
      return static_cast<std::size_t>(found - names.begin());
    }
    if (name.is_poisoned) {
      v_.scope.keep_silent();
      return std::nullopt;
    }
    auto builder = v_.diagnostics().add(Code::UnknownWord, name.span, {what, name.text});
    if (const auto nearest = nearest_name(name.text, names)) {
      builder.help_if(nearest, "did you mean `{}`?");
    } else {
      builder.help(fmt::format("there are {}", fmt::join(names, ", ")));
    }
    return std::nullopt;
  }

  void form() {
    if (!decl_.form) {
      return;
    }
    if (const auto found = find(*decl_.form, listed(kPlasticityFormNames), "form")) {
      made_.form = static_cast<PlasticityForm>(*found);
    }
  }

  void reward(const RewardUseDecl& use, const std::string& target, const std::vector<std::string>& known_sides) {
    if (!use.side.text.empty() &&
        std::find(known_sides.begin(), known_sides.end(), use.side.text) == known_sides.end()) {
      v_.diagnostics()
          .add(Code::UnknownSide, use.side.span, {target, use.side.text})
          .help_if(nearest_name(use.side.text, known_sides), "did you mean `{}`?");
    }
    if (const auto found = find(use.channel, listed(kRewardChannelNames), "reward")) {
      made_.rewards.push_back({use.side.text, static_cast<RewardChannel>(*found)});
      needs_eye(use.channel, made_.rewards.back().channel);
    }
  }

  void needs_eye(const NameDecl& name, RewardChannel channel) {
    std::optional<Eye> eye;
    if (channel == RewardChannel::LeftEyePan || channel == RewardChannel::LeftEyeTilt) {
      eye = Eye::Left;
    } else if (channel == RewardChannel::RightEyePan || channel == RewardChannel::RightEyeTilt) {
      eye = Eye::Right;
    }
    const auto has_eye = [&](const Instance& instance) {
      return instance.retina && (!eye || v_.circuit.retinas[index_of(*instance.retina)].eye == *eye);
    };
    const bool is_seen = std::any_of(v_.circuit.instances.begin(), v_.circuit.instances.end(), has_eye);
    const bool knows_eyes = v_.knows_all("inputs") && std::all_of(v_.is_sound_retina.begin(), v_.is_sound_retina.end(),
                                                                  [](bool is_sound) { return is_sound; });
    if (!is_seen && knows_eyes) {
      v_.diagnostics().add(Code::NoReward, name.span,
                           {name.text, !eye                ? "a retina"
                                       : *eye == Eye::Left ? "the left eye's retina"
                                                           : "the right eye's retina"});
    }
  }

  void numbers() {
    for (const PlasticityNumber& known : kPlasticityNumbers) {
      made_.*known.field = known.default_value;
    }
    std::vector<std::string> keys = {"reward", "form", "bounds", "learned", "cite", "about"};
    const std::vector<std::string> kRequired = {"learning_rate"};
    bool has_rate = false;
    for (const PlasticityNumber& known : kPlasticityNumbers) {
      keys.emplace_back(known.key);
    }
    for (const KeyedValue& given : decl_.numbers) {
      const auto known = std::find_if(kPlasticityNumbers.begin(), kPlasticityNumbers.end(),
                                      [&](const PlasticityNumber& number) { return given.key.text == number.key; });
      if (known == kPlasticityNumbers.end() || given.values.size() != 1) {
        v_.diagnostics()
            .add(Code::UnknownKey, given.key.span, {given.key.text, "`plasticity`"})
            .help_if(nearest_name(given.key.text, keys), "did you mean `{}`?");
        has_rate = has_rate || nearest_name(given.key.text, kRequired).has_value();
        continue;
      }
      has_rate = has_rate || known->default_text == nullptr;
      number(*known, given.values.front());
    }
    if (!has_rate) {
      v_.diagnostics()
          .add(Code::MissingKey,
               decl_.span.end > decl_.span.begin ? Span{decl_.span.file, decl_.span.begin, decl_.span.begin + 1}
                                                 : decl_.span,
               {"`plasticity`", "learning_rate"})
          .help("\"learning_rate\": \"0.1 Hz\"");
    }
  }

  void number(const PlasticityNumber& known, const ValueDecl& given) {
    const auto value = v_.scope.constant(given, known.key, known.dimension);
    if (!value) {
      return;
    }
    const bool is_time = known.dimension == kTime;
    const double highest = is_time ? kLongestTauMs : kHighestRateHz / 1000;
    if (!(*value > 0 && *value <= highest)) {
      v_.diagnostics().add(Code::OutOfRange, given.span,
                           {known.key, shown(*value, known.dimension),
                            fmt::format("above 0, at most {}", shown(highest, known.dimension))});
    }
    made_.*known.field = *value;
  }

  void bounds() {
    has_bounds_ = decl_.bounds.empty();  // the default ones
    if (decl_.bounds.size() != 2) {
      return;
    }
    const auto lowest = v_.scope.constant(decl_.bounds[0], "bounds", kNumber);
    const auto highest = v_.scope.constant(decl_.bounds[1], "bounds", kNumber);
    if (!lowest || !highest) {
      return;
    }
    if (*lowest > *highest) {
      v_.diagnostics().add(Code::RangeReversed, decl_.bounds_span,
                           {"`bounds`", shown(*lowest, kNumber), shown(*highest, kNumber)});
      return;
    }
    has_bounds_ = true;
    // The declared weight is within its own bounds.
    if (!(*lowest >= 0 && *lowest <= 1)) {
      v_.diagnostics().add(Code::OutOfRange, decl_.bounds[0].span, {"bounds", shown(*lowest, kNumber), "0 to 1"});
      has_bounds_ = false;
    }
    if (!(*highest >= 1 && *highest <= kHighestFactor)) {
      v_.diagnostics().add(Code::OutOfRange, decl_.bounds[1].span,
                           {"bounds", shown(*highest, kNumber), fmt::format("1 to {:g}", kHighestFactor)});
      has_bounds_ = false;
    }
    made_.lowest = *lowest;
    made_.highest = *highest;
  }

  void factors(const KeyedValue& learned) {
    LearnedFactors& made = made_.learned.emplace_back();
    made.pathway = learned.key.text;
    made.span = learned.key.span;
    if (!learned.is_list) {
      v_.diagnostics().add(Code::WrongType, learned.span,
                           {"`" + learned.key.text + "`", "a single value", "a list of factors"});
    }
    for (const ValueDecl& value : learned.values) {
      // A file holds thousands of them, all plain numbers.
      const auto factor = value.is_number ? std::optional(value.number) : v_.scope.constant(value, "learned", kNumber);
      if (factor && has_bounds_ && !(*factor >= made_.lowest && *factor <= made_.highest)) {
        v_.diagnostics().add(
            Code::OutOfRange, value.span,
            {"learned", shown(*factor, kNumber), fmt::format("{:g} to {:g}", made_.lowest, made_.highest)});
      }
      made.factors.push_back(factor.value_or(1));
    }
  }

  Validation& v_;
  const PlasticityDecl& decl_;
  Plasticity made_;
  bool has_bounds_ = true;  // that values can be held against
};

}  // namespace

std::optional<Plasticity> validate_plasticity(Validation& v, const PlasticityDecl& decl, const std::string& target,
                                              const std::vector<std::string>& known_sides) {
  return PlasticityValidator(v, decl).run(target, known_sides);
}

}  // namespace tectum
