#include "compiler/elaborate/connect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "compiler/elaborate/edge_rows.h"

namespace tectum {
namespace {

class Connector {
 public:
  Connector(const Projection& projection, const Circuit& circuit, const Instance& pre, const Instance& post,
            const RandomStream& random, PairVariables& variables, const std::function<bool(PairBlock&)>& take)
      : projection_(projection),
        random_(random),
        variables_(variables),
        take_(take),
        pre_size_(circuit.populations[index_of(pre.population)].size),
        post_size_(circuit.populations[index_of(post.population)].size),
        skips_autapses_(!projection.allows_autapses && &pre == &post) {}

  [[nodiscard]] const std::string& error() const { return error_; }

  bool run() {
    switch (projection_.rule) {
      case RuleKind::OneToOne:
        for (std::uint32_t i = 0; i < std::min(pre_size_, post_size_); ++i) {
          if (!add(i, i)) {
            return false;
          }
        }
        return flush();
      case RuleKind::AllToAll:
      case RuleKind::FixedProbability:
        return every_pair();
      case RuleKind::FixedInDegree:
        return fixed_degree(post_size_, pre_size_, true);
      case RuleKind::FixedOutDegree:
        return fixed_degree(pre_size_, post_size_, false);
      case RuleKind::EdgeList:
        return edge_list();
    }
    return true;
  }

 private:
  bool every_pair() {
    if (projection_.rule == RuleKind::FixedProbability && !projection_.where && projection_.probability &&
        projection_.probability->constant) {
      return pairs_by_chance(*projection_.probability->constant);
    }
    for (std::uint32_t pre = 0; pre < pre_size_; ++pre) {
      block_.share_done = static_cast<double>(pre) / pre_size_;
      for (std::uint32_t post = 0; post < post_size_; ++post) {
        if (skips_autapses_ && pre == post) {
          continue;
        }
        if (!add(pre, post)) {
          return false;
        }
      }
    }
    return flush();
  }

  /// The draws of keep_by_chance() where every pair has the same chance: only what is drawn enters the block.
  bool pairs_by_chance(double probability) {
    for (std::uint32_t pre = 0; pre < pre_size_; ++pre) {
      block_.share_done = static_cast<double>(pre) / pre_size_;
      const std::uint64_t first_pair = std::uint64_t{pre} * post_size_;
      for (std::uint32_t post = 0; post < post_size_; ++post) {
        if (!(random_.uniform(first_pair + post) < probability) || (skips_autapses_ && pre == post)) {
          continue;
        }
        block_.add(pre, post);
        if (block_.size() == kPairBlockSize && !take_drawn()) {
          return false;
        }
      }
    }
    return take_drawn();
  }

  bool take_drawn() {
    const bool goes_on = block_.size() == 0 || take_(block_);
    block_.clear();
    return goes_on;
  }

  bool edge_list() {
    const EdgeTable& table = *projection_.edges;
    EdgeRows reader(table);
    std::vector<double> row(table.columns.size());
    block_.edge_columns.resize(row.size() - 2);
    while (reader.next_numbers(row)) {
      const auto pre = local_index(row[0], pre_size_, "presynaptic", reader);
      const auto post = local_index(row[1], post_size_, "postsynaptic", reader);
      if (!pre || !post) {
        return false;
      }
      block_.share_done = reader.share_read();
      for (std::size_t c = 2; c < row.size(); ++c) {
        block_.edge_columns[c - 2].push_back(row[c]);
      }
      if (!add(*pre, *post)) {
        return false;
      }
    }
    error_ = reader.error();
    return error_.empty() && flush();
  }

  std::optional<std::uint32_t> local_index(double cell, std::uint32_t size, const char* which, const EdgeRows& reader) {
    const double index = cell - static_cast<double>(projection_.edges->first_index);
    if (!(index >= 0 && index < size) || index != std::floor(index)) {
      error_ = fmt::format("{}:{}: the {} neuron {:g} is not one of {} to {}", reader.path(), reader.line(), which,
                           cell, projection_.edges->first_index, projection_.edges->first_index + size - 1);
      return std::nullopt;
    }
    return static_cast<std::uint32_t>(index);
  }

  bool add(std::uint32_t pre, std::uint32_t post) {
    block_.add(pre, post);
    return block_.size() < kPairBlockSize || flush();
  }

  bool flush() {
    keep_where();
    if (projection_.rule == RuleKind::FixedProbability) {
      keep_by_chance();
    }
    return take_drawn();
  }

  void keep_where() { tectum::keep_where(projection_, variables_, block_, values_); }

  /// The draw belongs to the pair, so that `where` never shifts it to another.
  void keep_by_chance() {
    if (!projection_.probability || block_.size() == 0) {
      return;
    }
    variables_.evaluate(PairUse::Probability, *projection_.probability, block_, values_);
    keep_pairs(block_, [&](std::size_t i) {
      const std::uint64_t pair = std::uint64_t{block_.pre[i]} * post_size_ + block_.post[i];
      return random_.uniform(pair) < values_[i];
    });
  }

  /// For each of `count` neurons, `degree` different partners out of those that `where` leaves: the first entries
  /// of a Fisher-Yates shuffle, draw k of neuron i at index i 2^32 + k.
  bool fixed_degree(std::uint32_t count, std::uint32_t partner_count, bool is_in_degree) {
    if (!projection_.where) {
      return fixed_degree_of_any(count, partner_count, is_in_degree);
    }
    std::vector<std::uint32_t> partners;
    for (std::uint32_t i = 0; i < count; ++i) {
      partners.clear();
      for (std::uint32_t j = 0; j < partner_count; ++j) {
        if (skips_autapses_ && i == j) {
          continue;
        }
        block_.add(is_in_degree ? j : i, is_in_degree ? i : j);
        if (block_.size() == kPairBlockSize || j + 1 == partner_count) {
          drain(partners, is_in_degree);
        }
      }
      drain(partners, is_in_degree);
      const auto degree = std::min<std::size_t>(projection_.degree, partners.size());
      for (std::size_t k = 0; k < degree; ++k) {
        const std::uint64_t index = (std::uint64_t{i} << 32U) + k;
        std::swap(partners[k], partners[k + random_.below(index, static_cast<std::uint32_t>(partners.size() - k))]);
      }
      std::sort(partners.begin(), partners.begin() + static_cast<std::ptrdiff_t>(degree));
      for (std::size_t k = 0; k < degree; ++k) {
        block_.add(is_in_degree ? partners[k] : i, is_in_degree ? i : partners[k]);
      }
      if (block_.size() > 0 && !take_(block_)) {
        return false;
      }
      block_.clear();
    }
    return true;
  }

  /// The same draws where every neuron may be a partner: instead of listing them anew, the swaps are undone.
  bool fixed_degree_of_any(std::uint32_t count, std::uint32_t partner_count, bool is_in_degree) {
    const std::uint32_t others = skips_autapses_ ? partner_count - 1 : partner_count;
    const auto degree = std::min<std::uint32_t>(projection_.degree, others);
    std::vector<std::uint32_t> partners(others);
    std::iota(partners.begin(), partners.end(), 0U);
    std::vector<std::uint32_t> swapped(degree);
    std::vector<std::uint32_t> chosen(degree);
    for (std::uint32_t i = 0; i < count; ++i) {
      block_.share_done = static_cast<double>(i) / count;
      for (std::uint32_t k = 0; k < degree; ++k) {
        swapped[k] = k + random_.below((std::uint64_t{i} << 32U) + k, others - k);
        std::swap(partners[k], partners[swapped[k]]);
      }
      for (std::uint32_t k = 0; k < degree; ++k) {
        chosen[k] = partners[k] + (skips_autapses_ && partners[k] >= i ? 1 : 0);
      }
      for (std::uint32_t k = degree; k-- > 0;) {
        std::swap(partners[k], partners[swapped[k]]);
      }
      std::sort(chosen.begin(), chosen.end());
      for (const std::uint32_t partner : chosen) {
        if (!add(is_in_degree ? partner : i, is_in_degree ? i : partner)) {
          return false;
        }
      }
    }
    return flush();
  }

  void drain(std::vector<std::uint32_t>& partners, bool is_in_degree) {
    keep_where();
    const std::vector<std::uint32_t>& found = is_in_degree ? block_.pre : block_.post;
    partners.insert(partners.end(), found.begin(), found.end());
    block_.clear();
  }

  const Projection& projection_;
  const RandomStream& random_;
  PairVariables& variables_;
  const std::function<bool(PairBlock&)>& take_;
  std::uint32_t pre_size_;
  std::uint32_t post_size_;
  bool skips_autapses_;
  PairBlock block_;
  std::vector<double> values_;
  std::string error_;
};

}  // namespace

bool connect(const Projection& projection, const Circuit& circuit, const Instance& pre, const Instance& post,
             const RandomStream& random, PairVariables& variables, const std::function<bool(PairBlock&)>& take,
             std::string& error) {
  Connector connector(projection, circuit, pre, post, random, variables, take);
  const bool is_done = connector.run();
  error = connector.error();
  return is_done;
}

}  // namespace tectum
