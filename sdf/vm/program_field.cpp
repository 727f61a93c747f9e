#include <fmt/format.h>

#include <fstream>
#include <map>
#include <mutex>
#include <sstream>

#include "sdf/error.h"
#include "sdf/guard.h"
#include "sdf/vm/extent.h"
#include "sdf/vm/program_field.h"
#include "sdf/vm/split.h"
#include "sdf/vm_field.h"

namespace limn {
namespace {

using namespace vm;

constexpr double kFarAway = 1e9;    // no length of limn's is larger
constexpr double kCutAt = 1e4;      // where a surface without end is cut, if its slope has no bound
constexpr double kSheet = 1e-10;    // added to fields with parts without thickness, so that rounding makes no specks of them
constexpr double kStillEven = 8.0;  // a slope that grows by no more than this to the end of space is bounded well enough there

/// What all parts of a field share: where it is at or below a level.
struct Reach {
  RegisterProgram whole{};
  bool reads[3] = {};
  double scale = 1.0;
  Box bounds{};          ///< Of {f <= 0}.
  bool clamped = false;  ///< Outside `region` the field is that of the nearest point in it, plus `growth` times the distance.
  Box region{};
  double growth = 0.0;
  bool sheets = false;  ///< Somewhere a part and its opposite touch: what lies between them has no thickness.
  mutable std::mutex mutex{};
  mutable std::map<double, Box> known{};

  Box at(double level) const {
    if (!(level > 0.0)) return bounds;
    if (clamped) {
      const double by = level / (scale * growth);
      return {glm::min(bounds.lower, region.lower - by), glm::max(bounds.upper, region.upper + by)};
    }
    const std::lock_guard lock(mutex);
    const auto found = known.find(level);
    if (found != known.end()) return found->second;
    return known[level] = find_extent(whole, reads, level / scale).box;
  }
};

struct VmShape {
  RegisterProgram program{};
  std::shared_ptr<const Reach> reach{};
};

template <class T>
void evaluate(const void* shape, const T* x, const T* y, const T* z, T* values, size_t count) {
  static thread_local std::vector<T> scratch;
  run(static_cast<const VmShape*>(shape)->program, x, y, z, values, count, scratch);
}

template <>
void evaluate<BoxSlope>(const void* shape, const BoxSlope* x, const BoxSlope* y, const BoxSlope* z, BoxSlope* values, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    values[i] = by_axis(x[i], y[i], z[i], [&](const Slope& sx, const Slope& sy, const Slope& sz) {
      Slope value;
      evaluate(shape, &sx, &sy, &sz, &value, 1);
      return value;
    });
  }
}

double support(const void* shape, const glm::dvec3& direction, double level) {
  const Box box = static_cast<const VmShape*>(shape)->reach->at(level);
  if (box.empty()) return -kInfinity;
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] != 0.0) sum += direction[i] * (direction[i] > 0.0 ? box.upper[i] : box.lower[i]);
  }
  return sum;
}

void record(const void* shape, const Vector3<Recorded>& p, Recorded& value) {
  std::vector<Recorded> scratch;
  run(static_cast<const VmShape*>(shape)->program, &p.x, &p.y, &p.z, &value, 1, scratch);
}

const ShapeFunctions& functions_of(bool recorded) {
  static constexpr ShapeFunctions plain{
      {evaluate<float>, evaluate<double>, evaluate<Dual>, evaluate<Jet>, evaluate<Interval>, evaluate<Slope>, evaluate<BoxSlope>},
      support,
      nullptr,
      nullptr,
      nullptr,
      nullptr};
  static constexpr ShapeFunctions lanes{
      {evaluate<float>, evaluate<double>, evaluate<Dual>, evaluate<Jet>, evaluate<Interval>, evaluate<Slope>, evaluate<BoxSlope>},
      support,
      record,
      nullptr,
      nullptr,
      nullptr};
  return recorded ? lanes : plain;
}

void find_axes(const Program& program, bool reads[3]) {
  for (const Step& step : program) {
    if (step.operation <= Operation::z) reads[static_cast<int>(step.operation)] = true;
  }
}

/// The box, a little larger, so that nothing of the surface lies at its end; finite.
Box around(const Box& bounds) {
  double side = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (std::isfinite(bounds.upper[i] - bounds.lower[i])) side = std::max(side, bounds.upper[i] - bounds.lower[i]);
  }
  const double margin = side > 0.0 ? 0.1 * side : 1.0;
  Box region;
  for (int i = 0; i < 3; ++i) {
    region.lower[i] = std::isfinite(bounds.lower[i]) ? bounds.lower[i] - margin : -kCutAt;
    region.upper[i] = std::isfinite(bounds.upper[i]) ? bounds.upper[i] + margin : kCutAt;
  }
  return region;
}

/// Runs without sharing registers, so that every value can be looked at afterwards.
RegisterProgram with_all_values(const Program& program) {
  RegisterProgram all;
  for (const Step& step : program)
    all.steps.push_back({step.operation, static_cast<std::uint32_t>(all.steps.size()), step.a, step.b, step.c, step.constant});
  all.registers = static_cast<std::uint32_t>(program.size());
  all.result = all.registers - 1;
  return all;
}

/// The largest value that turns up on the way: what rounding is relative to.
double largest_value(const Program& program, const Box& region) {
  const RegisterProgram all = with_all_values(program);
  const Interval x{region.lower.x, region.upper.x}, y{region.lower.y, region.upper.y}, z{region.lower.z, region.upper.z};
  std::vector<Interval> values;
  Interval result;
  run(all, &x, &y, &z, &result, 1, values);
  double largest = 0.0;
  for (const Interval& value : values) {
    const double size = magnitude(value);
    if (std::isfinite(size)) largest = std::max(largest, size);
  }
  return largest;
}

[[noreturn]] void refuse_slope(const Program& program, const Box& region, const std::string& file) {
  const RegisterProgram all = with_all_values(program);
  std::uint32_t line = 0;
  for (int axis = 0; axis < 3 && line == 0; ++axis) {
    Slope p[3], result;
    for (int i = 0; i < 3; ++i) p[i] = {{region.lower[i], region.upper[i]}, i == axis ? Interval{1.0, 1.0} : Interval{0.0, 0.0}};
    std::vector<Slope> values;
    run(all, &p[0], &p[1], &p[2], &result, 1, values);
    for (size_t i = 0; i < program.size() && line == 0; ++i) {
      if (!std::isfinite(magnitude(checked(values[i]).slope))) line = program[i].line;
    }
  }
  throw InputError({line > 0 ? fmt::format("{}:{}", file, line) : file, "",
                    fmt::format("within {:.3g},{:.3g},{:.3g} and {:.3g},{:.3g},{:.3g}", region.lower.x, region.lower.y, region.lower.z,
                                region.upper.x, region.upper.y, region.upper.z),
                    "the value's slope has no bound near the surface", "no division by 0 and no square root or logarithm of 0 there"});
}

/// The part's list with every point replaced by the nearest one in the region, plus `growth` times the distance from there.
Program clamped_part(const Program& part, const Box& region, const bool reads[3], double growth) {
  Program out;
  const auto put = [&](Operation operation, std::uint32_t a = 0, std::uint32_t b = 0, std::uint32_t c = 0, double constant = 0.0) {
    out.push_back({operation, a, b, c, constant, 0});
    return static_cast<std::uint32_t>(out.size() - 1);
  };
  std::uint32_t moved[3] = {};
  std::vector<std::uint32_t> away;
  for (int i = 0; i < 3; ++i) {
    if (!reads[i]) continue;
    const std::uint32_t at = put(static_cast<Operation>(i));
    const std::uint32_t low = put(Operation::constant, 0, 0, 0, region.lower[i]), high = put(Operation::constant, 0, 0, 0, region.upper[i]);
    moved[i] = put(Operation::minimum, put(Operation::maximum, at, low), high);
    away.push_back(put(Operation::subtract, at, moved[i]));
  }
  std::vector<std::uint32_t> number(part.size(), 0);
  for (size_t i = 0; i < part.size(); ++i) {
    const Step& step = part[i];
    number[i] = step.operation <= Operation::z ? moved[static_cast<int>(step.operation)]
                                               : put(step.operation, number[step.a], number[step.b], number[step.c], step.constant);
  }
  const std::uint32_t value = number.back();
  if (away.empty()) return part;
  const std::uint32_t distance = away.size() == 1   ? put(Operation::absolute, away[0])
                                 : away.size() == 2 ? put(Operation::norm2, away[0], away[1])
                                                    : put(Operation::norm3, away[0], away[1], away[2]);
  put(Operation::add, value, put(Operation::multiply_constant, distance, 0, 0, growth));
  return out;
}

/// Whether two parts are each other's opposite, to rounding.
bool has_sheets(const SplitProgram& split) {
  std::map<std::uint32_t, std::vector<Part>> by_step;
  for (const Part& part : split.parts) by_step[part.step].push_back(part);
  for (const auto& [step, parts] : by_step) {
    for (size_t i = 0; i < parts.size(); ++i) {
      for (size_t k = 0; k < i; ++k) {
        const bool opposite = std::fabs(parts[i].scale + parts[k].scale) <= 1e-12 * std::fabs(parts[i].scale);
        if (opposite && std::fabs(parts[i].added + parts[k].added) <= 1e-12 * (std::fabs(parts[i].added) + 1e-3)) return true;
      }
    }
  }
  return false;
}

/// How steep the parts are, each and all.
struct Steepness {
  std::vector<double> each{};
  double most = 0.0;
};
Steepness steepness(const std::vector<Program>& parts, const Box& box) {
  Steepness result;
  for (const Program& part : parts) {
    bool reads[3] = {};
    find_axes(part, reads);
    result.each.push_back(steepest(with_registers(part), box, reads));
    result.most = std::max(result.most, result.each.back());
  }
  return result;
}

/// Instructions for the tree; the deeper child first, so that few slots are needed.
class Emitter {
 public:
  Emitter(const SplitProgram& split, FieldProgram& out) : split_(split), out_(out), depth_(split.nodes.size(), 1) {
    for (size_t i = 0; i < depth_.size(); ++i) {
      const Node& node = split.nodes[i];
      if (node.part >= 0) continue;
      const int a = depth_[static_cast<size_t>(node.left)], b = depth_[static_cast<size_t>(node.right)];
      depth_[i] = a == b ? a + 1 : std::max(a, b);
    }
  }
  void emit(int index, std::uint32_t target) {
    const Node& node = split_.nodes[static_cast<size_t>(index)];
    out_.slots = std::max(out_.slots, target + 1);
    if (node.part >= 0) {
      out_.instructions.push_back({FieldOperation::leaf, target, 0, 0, static_cast<std::uint32_t>(node.part), 0.0});
      return;
    }
    const bool swapped = depth_[static_cast<size_t>(node.right)] > depth_[static_cast<size_t>(node.left)];
    emit(swapped ? node.right : node.left, target);
    emit(swapped ? node.left : node.right, target + 1);
    out_.instructions.push_back({node.maximum ? FieldOperation::maximum : FieldOperation::minimum, target, target, target + 1, 0, 0.0});
  }

 private:
  const SplitProgram& split_;
  FieldProgram& out_;
  std::vector<int> depth_;
};

std::string unbounded_axes(const Extent& extent, const bool reads[3]) {
  std::string axes;
  bool certain = true;
  for (int i = 0; i < 3; ++i) {
    const bool down = !std::isfinite(extent.box.lower[i]), up = !std::isfinite(extent.box.upper[i]);
    if (!down && !up) continue;
    axes += (axes.empty() ? "" : ", ") + std::string(1, static_cast<char>('x' + i)) + (reads[i] ? "" : " (which the file does not use)");
    certain = certain && (!down || extent.proven[i][0]) && (!up || extent.proven[i][1]);
  }
  if (axes.empty()) return {};
  return certain ? "the surface has no end along " + axes : "no bounds of the surface could be proven along " + axes;
}

Field assemble(const SplitProgram& split, const std::vector<Program>& parts, const Steepness& steep,
               const std::shared_ptr<const Reach>& reach) {
  auto program = std::make_shared<FieldProgram>();
  program->traits.lipschitz = 1e-300;
  for (size_t i = 0; i < parts.size(); ++i) {
    Program part = reach->clamped ? clamped_part(parts[i], reach->region, reach->reads, reach->growth) : parts[i];
    part.push_back({Operation::multiply_constant, static_cast<std::uint32_t>(part.size() - 1), 0, 0, reach->scale, 0});
    if (reach->sheets) part.push_back({Operation::add_constant, static_cast<std::uint32_t>(part.size() - 1), 0, 0, kSheet, 0});
    part = simplified(part);
    FieldLeaf leaf;
    leaf.shape = std::make_shared<const VmShape>(VmShape{with_registers(part), reach});
    leaf.functions = &functions_of(recordable(part));
    leaf.lipschitz = std::max(1e-12, reach->scale * (steep.each[i] + (reach->clamped ? reach->growth : 0.0)));
    program->traits.lipschitz = std::max(program->traits.lipschitz, leaf.lipschitz);
    program->leaves.push_back(std::move(leaf));
  }
  Emitter(split, *program).emit(static_cast<int>(split.nodes.size()) - 1, 0);
  program->traits.bounds = sublevel_bounds(*program, 0.0);
  return Field(std::move(program));
}

}  // namespace

VmField vm_field(std::string_view text, const std::string& file) { return vm::field_of(parse(text, file), file); }

VmField vm::field_of(const Program& read, const std::string& file) {
  const Program program = simplified(read);
  auto reach = std::make_shared<Reach>();
  reach->whole = with_registers(program);
  find_axes(program, reach->reads);
  const Extent extent = find_extent(reach->whole, reach->reads, 0.0);
  if (extent.box.empty())
    throw InputError({file, "", "", fmt::format("the value is above 0 everywhere within {:.0f} units: there is no surface", kFarthest),
                      "a value that is negative inside"});
  reach->bounds = extent.box;
  reach->region = around(extent.box);

  const SplitProgram pieces = split(program);
  reach->sheets = has_sheets(pieces);
  std::vector<Program> parts;
  for (const Part& part : pieces.parts) parts.push_back(part_of(program, part));
  Steepness steep = steepness(parts, reach->region);
  if (!std::isfinite(steep.most)) refuse_slope(program, reach->region, file);
  const Steepness far = steepness(parts, {glm::dvec3(-kFarAway), glm::dvec3(kFarAway)});
  reach->clamped = !(far.most <= kStillEven * steep.most);
  reach->growth = std::max(steep.most, 1e-12);
  if (!reach->clamped) steep = far;

  // Bounds leave room for rounding in proportion to the slope and to how far from the origin the field is looked at.
  double farthest = 1e-3;
  for (int i = 0; i < 3; ++i) {
    if (reach->reads[i]) farthest = std::max({farthest, std::fabs(reach->region.lower[i]), std::fabs(reach->region.upper[i])});
  }
  const double rounding = 0.1 * largest_value(program, reach->region) / farthest;
  reach->scale = 1.0 / std::max({steep.most + (reach->clamped ? reach->growth : 0.0), rounding, 1e-12});
  return {assemble(pieces, parts, steep, reach), reach->scale, unbounded_axes(extent, reach->reads)};
}

VmField load_vm(const std::filesystem::path& file) {
  check_readable(file, "a .vm file");
  constexpr std::uintmax_t kLongest = 64 << 20;  // ten thousand lines with names of any sense are far below this
  if (std::filesystem::file_size(file) > kLongest) throw InputError({file.string(), "", "", "the file is too long", "at most 64 MB"});
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw InputError({file.string(), "", "", "cannot be read", "a .vm file"});
  return vm_field(text.str(), file.string());
}

}  // namespace limn
