#include "compiler/elaborate/cell_edges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "compiler/elaborate/edge_rows.h"

namespace tectum {
namespace {

/// The sides that a list of endpoints names.
std::vector<bool> named_instances(const Circuit& circuit, const std::vector<Endpoint>& ends) {
  std::vector<bool> named(circuit.instances.size(), false);
  for (const Endpoint& end : ends) {
    named[index_of(circuit.populations[index_of(end.population)].first_instance)] = true;  // cells have no sides
  }
  return named;
}

/// Rows in the order of key(row), equal ones as they were: one pass of a counting sort.
template <typename Key>
std::vector<std::uint32_t> sorted_by(const std::vector<std::uint32_t>& rows, std::size_t key_count, const Key& key) {
  std::vector<std::size_t> begin(key_count + 1, 0);
  for (const std::uint32_t row : rows) {
    ++begin[key(row) + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> sorted(rows.size());
  for (const std::uint32_t row : rows) {
    sorted[begin[key(row)]++] = row;
  }
  return sorted;
}

}  // namespace

CellEdges::CellEdges(const Circuit& circuit, const Network& network, const Projection& projection)
    : circuit_(circuit), network_(network) {
  const std::size_t columns = projection.edges->columns.size() - 2;
  columns_.resize(columns);
  pre_sums_.assign(columns, std::vector<double>(network.neuron_count(), 0));
  post_sums_ = pre_sums_;
  for (std::uint32_t p = 0; p < network.populations.size(); ++p) {
    instance_of_.resize(instance_of_.size() + network.populations[p].size, p);
  }
  read(projection);
}

void CellEdges::read(const Projection& projection) {
  const EdgeTable& table = *projection.edges;
  const CellTable& pre_cells = *circuit_.cell_tables[table.pre_table];
  const CellTable& post_cells = *circuit_.cell_tables[table.post_table];
  const std::vector<bool> is_from = named_instances(circuit_, projection.from);
  const std::vector<bool> is_to = named_instances(circuit_, projection.to);
  EdgeRows reader(table);
  std::vector<std::string_view> fields(table.columns.size());
  std::vector<double> values(columns_.size());
  for (CsvRow row = reader.next(fields); row != CsvRow::End; row = reader.next(fields)) {
    if (row == CsvRow::Bad) {
      bad_.add(reader.row_error());
      continue;
    }
    const auto pre = pre_cells.numbers.find(fields[0]);
    const auto post = post_cells.numbers.find(fields[1]);
    if (!pre || !post) {
      bad_.add(fmt::format("{}:{}: `{}` is no cell of table `{}`", reader.path(), reader.line(),
                           (pre ? fields[1] : fields[0]).substr(0, 40), (pre ? post_cells : pre_cells).name));
      continue;
    }
    bool is_sound = true;
    for (std::size_t c = 0; c < values.size() && is_sound; ++c) {
      is_sound = reader.read_number(fields[c + 2], c + 2, values[c]);
    }
    if (is_sound) {
      add_row(values, pre_cells.places[*pre], post_cells.places[*post], is_from, is_to);
    } else {
      bad_.add(reader.row_error());
    }
  }
  error_ = reader.error();
}

void CellEdges::add_row(const std::vector<double>& values, const CellPlace& pre, const CellPlace& post,
                        const std::vector<bool>& is_from, const std::vector<bool>& is_to) {
  const auto neuron = [&](const CellPlace& place) {
    return network_.populations[place.instance].first_neuron + place.index;
  };
  const bool has_pre = pre.instance != CellPlace::kNowhere, has_post = post.instance != CellPlace::kNowhere;
  for (std::size_t c = 0; c < values.size(); ++c) {
    if (has_pre) {
      pre_sums_[c][neuron(pre)] += values[c];
    }
    if (has_post) {
      post_sums_[c][neuron(post)] += values[c];
    }
  }
  if (!has_pre || !has_post || !is_from[pre.instance] || !is_to[post.instance]) {
    return;
  }
  pre_.push_back(neuron(pre));
  post_.push_back(neuron(post));
  for (std::size_t c = 0; c < values.size(); ++c) {
    columns_[c].push_back(values[c]);
  }
}

void CellEdges::for_each_pathway(
    const std::function<bool(std::uint32_t, std::uint32_t, std::span<const std::uint32_t>)>& visit) const {
  std::vector<std::uint32_t> rows(size());
  std::iota(rows.begin(), rows.end(), 0U);
  const std::size_t sides = network_.populations.size();
  rows = sorted_by(rows, sides, [&](std::uint32_t row) { return instance_of(post_[row]); });
  rows = sorted_by(rows, sides, [&](std::uint32_t row) { return instance_of(pre_[row]); });
  for (std::size_t begin = 0; begin < rows.size();) {
    const std::uint32_t pre = instance_of(pre_[rows[begin]]), post = instance_of(post_[rows[begin]]);
    std::size_t end = begin;
    while (end < rows.size() && instance_of(pre_[rows[end]]) == pre && instance_of(post_[rows[end]]) == post) {
      ++end;
    }
    if (!visit(pre, post, std::span(rows).subspan(begin, end - begin))) {
      return;
    }
    begin = end;
  }
}

void CellEdges::fill(std::span<const std::uint32_t> rows, PairBlock& block) const {
  const std::size_t count = columns_.size();
  block.edge_columns.resize(3 * count);
  const std::uint32_t first_pre = network_.populations[instance_of(pre_[rows.front()])].first_neuron;
  const std::uint32_t first_post = network_.populations[instance_of(post_[rows.front()])].first_neuron;
  for (const std::uint32_t row : rows) {
    block.add(pre_[row] - first_pre, post_[row] - first_post);
    for (std::size_t c = 0; c < count; ++c) {
      block.edge_columns[c].push_back(columns_[c][row]);
      block.edge_columns[count + c].push_back(pre_sums_[c][pre_[row]]);
      block.edge_columns[2 * count + c].push_back(post_sums_[c][post_[row]]);
    }
  }
}

}  // namespace tectum
