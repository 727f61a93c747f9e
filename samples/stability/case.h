#pragma once
// A case of the corpus: a scene that breaks methods, what must hold of it, and where a method is known to fail. Cases are TOML files; a
// scene file's tables ([camera], [surface], [[border]], [[object]]) beside these:
//
//     [case]       row, breaks, holds: the catalogue's words; check = NAME; surfaces; methods (or "all", less those of `without`; the
//                  [[border]]s come after them), views, sizes = [[w, h], …], draws, bound, outer, says (or a list): what the program must
//                  say, in a sentence with a number, wherever the property held or degraded
//     [with]       parameters of the check
//     [set]        name = number; "$name" in the rest of the file stands for it (in quotes, so that the file stays TOML)
//     [random]     name = [low, high]: the same, drawn from the seed; whole numbers where both are
//     [[mesh]]     file = "a.obj" and its text, or maker = "schwarz_lantern" with its parameters: which an [[object]] names
//     [volume]     voxels, half_width: fields are sampled first, as if they came from a .vdb
//     [[reference]] an [[object]] of the true scene, where it is not the one that is drawn
//     [[variant]]  the scene again, changed: scale, translate, turned, reversed, threads, tile, simd = "least", set = { name = number }
//     [[expect]]   surfaces, methods (default: all), and bound, outer, or refused = "words", or fails = [low, high] and says = "words":
//                  there the number must lie where the property does not hold and the program must say so; says alone: as in [case]

#include <map>
#include <optional>

#include "raymarch/surface.h"
#include "samples/input/input.h"
#include "samples/stability/results.h"

namespace limn {

/// The same scene, otherwise.
struct StabilityVariant {
  double scale = 1.0;                   ///< Factor on all lengths; above 0.
  glm::dvec3 translate{0.0};            ///< After the scaling.
  bool turned = false;                  ///< Meshes with their faces turned round.
  bool reversed = false;                ///< Meshes with their faces in reverse order.
  int threads = 0,                      ///< 0: all.
      tile_px = 16;                     ///< ExecutionSettings::tile_px.
  bool least_simd = false;              ///< On the narrowest SIMD target.
  std::map<std::string, double> set{};  ///< Over StabilityCase::set.
  std::string words{};                  ///< For messages.
};

/// An [[expect]] table: what other bounds hold for some surfaces and methods, and where they fail.
struct StabilityExpectation {
  std::vector<std::string> surfaces{},               ///< Empty: all.
      methods{};                                     ///< Empty: all. A method stands for all its parameters, or is given with them.
  std::optional<double> bound{},                     ///< Held up to here; unset: the case's.
      outer{};                                       ///< Degraded up to here; unset: the case's.
  std::optional<std::pair<double, double>> fails{};  ///< Lowest and highest number with which it must fail; unset: it must not.
  std::vector<std::string> says{};                   ///< Words that a sentence of the program must hold, with a number; each of them.
  std::string refused{};                             ///< Words of the InputError that must come; empty: none may come.
};

/// A case, parsed: see the head of this file.
struct StabilityCase {
  StabilityCaseText text{};                      ///< Name, row and the catalogue's words.
  std::string source{};                          ///< The TOML.
  std::string file{};                            ///< For messages; relative paths start beside it.
  std::vector<std::string> surfaces{};           ///< "all" among them: every one.
  std::vector<std::string> methods{};            ///< "all" among them: every one. Empty: the scene's [[border]]s alone.
  std::vector<std::string> without{};            ///< Methods that "all" leaves out.
  bool has_borders = false;                      ///< Whether the scene has [[border]]s.
  int views = 1;                                 ///< 1: the scene's own camera; more: as many directions, turned at random.
  std::vector<glm::ivec2> sizes_px{};            ///< Width and height of the pictures.
  int draws = 1;                                 ///< How often the random parameters are drawn; at least 1.
  double bound = 0.0,                            ///< Held up to here.
      outer = 0.0;                               ///< Degraded up to here.
  std::vector<std::string> says{};               ///< Words that the program must say wherever the property held or degraded.
  std::map<std::string, ParameterInput> with{};  ///< Parameters of the check.
  std::map<std::string, double> set{};           ///< Values of "$name".
  /// From what a random parameter is drawn.
  struct Range {
    double low = 0.0,    ///< Included.
        high = 0.0;      ///< Included where `whole`.
    bool whole = false;  ///< Whole numbers only.
  };
  std::map<std::string, Range> random{};     ///< By name.
  std::vector<StabilityVariant> variants{};  ///< The [[variant]] tables, in order.
  /// The [[expect]] tables, in order; of those that are about a cell the last one decides each point.
  std::vector<StabilityExpectation> expectations{};
};

/// Throws InputError with file, line and what would be right.
StabilityCase parse_case(const std::string& text, const std::string& file);

/// What a case comes to with its parameters given values.
struct StabilityScene {
  SceneInput input{};  ///< As if read from a scene file.
  Scene reference{};   ///< Empty where the scene itself is the truth.
};
/// The scene of a case with "$name" replaced by `values`. Throws InputError.
StabilityScene scene_of_case(const StabilityCase& one, const std::map<std::string, double>& values);

/// Values of all parameters in draw number `draw` from `seed`; the same on every machine, whatever other cases there are.
std::map<std::string, double> drawn_parameters(const StabilityCase& one, std::uint64_t seed, int draw);
/// A stream of numbers in [0, 1) that belongs to a case, a seed and a draw.
class StabilityRandom {
 public:
  /// Equal arguments give equal numbers.
  StabilityRandom(const std::string& name, std::uint64_t seed, int draw);
  double next();  ///< The next number of the stream.

 private:
  std::uint64_t state_;
};

}  // namespace limn
