#include "tests/bench/occ_lines.h"

#if LIMN_BENCH_OCC

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <HLRAlgo_Projector.hxx>
#include <HLRBRep_Algo.hxx>
#include <HLRBRep_HLRToShape.hxx>
#include <HLRBRep_PolyAlgo.hxx>
#include <HLRBRep_PolyHLRToShape.hxx>
#include <Standard_Version.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS_Shape.hxx>
#include <chrono>
#include <cmath>
#include <gp_Ax2.hxx>
#include <numbers>

namespace limn::bench {
namespace {

constexpr double kMesh_px = 0.05;

gp_Pnt point(const glm::dvec3& p) { return {p.x, p.y, p.z}; }
gp_Dir direction(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
gp_Ax2 upright(const glm::dvec3& p) { return {point(p), gp_Dir(0.0, 1.0, 0.0)}; }

TopoDS_Shape hexagon(const PartSolid& solid) {
  BRepBuilderAPI_MakePolygon polygon;
  const double radius = solid.size.x / std::cos(std::numbers::pi / 6.0);
  for (int i = 0; i < 6; ++i) {
    const double turn = (i + 0.5) * std::numbers::pi / 3.0;
    polygon.Add(point(solid.center + glm::dvec3(radius * std::cos(turn), -solid.size.y, radius * std::sin(turn))));
  }
  polygon.Close();
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(polygon.Wire()).Face(), gp_Vec(0.0, 2.0 * solid.size.y, 0.0)).Shape();
}

TopoDS_Shape shape_of(const PartSolid& solid) {
  const glm::dvec3 &size = solid.size, &center = solid.center;
  switch (solid.kind) {
    case PartSolid::Kind::sphere:
      return BRepPrimAPI_MakeSphere(point(center), size.x).Shape();
    case PartSolid::Kind::cylinder:
      return BRepPrimAPI_MakeCylinder(upright(center - glm::dvec3(0.0, size.y, 0.0)), size.x, 2.0 * size.y).Shape();
    case PartSolid::Kind::torus:
      return BRepPrimAPI_MakeTorus(upright(center), size.x, size.y).Shape();
    case PartSolid::Kind::box:
      return BRepPrimAPI_MakeBox(point(center - size), point(center + size)).Shape();
    case PartSolid::Kind::hexagon:
      break;
  }
  return hexagon(solid);
}

TopoDS_Shape shape_of(const SolidPart& part) {
  TopTools_ListOfShape first, joined, cut;
  for (const PartSolid& solid : part.solids) (solid.cut ? cut : first.IsEmpty() ? first : joined).Append(shape_of(solid));
  TopoDS_Shape shape = first.First();
  const auto apply = [&](auto&& operation, const TopTools_ListOfShape& tools) {
    if (tools.IsEmpty()) return;
    TopTools_ListOfShape body;
    body.Append(shape);
    operation.SetArguments(body);
    operation.SetTools(tools);
    operation.Build();
    shape = operation.Shape();
  };
  apply(BRepAlgoAPI_Fuse(), joined);
  apply(BRepAlgoAPI_Cut(), cut);
  return shape;
}

/// All lines, visible and hidden, as limn's view graph has them.
template <class ToShape>
void take_lines(ToShape& lines) {
  lines.VCompound();
  lines.Rg1LineVCompound();
  lines.OutLineVCompound();
  lines.HCompound();
  lines.Rg1LineHCompound();
  lines.OutLineHCompound();
}

void draw_exact(const TopoDS_Shape& shape, const HLRAlgo_Projector& projector) {
  Handle(HLRBRep_Algo) algorithm = new HLRBRep_Algo();
  algorithm->Add(shape);
  algorithm->Projector(projector);
  algorithm->Update();
  algorithm->Hide();
  HLRBRep_HLRToShape lines(algorithm);
  take_lines(lines);
}

void draw_polygonal(const TopoDS_Shape& shape, const HLRAlgo_Projector& projector) {
  Handle(HLRBRep_PolyAlgo) algorithm = new HLRBRep_PolyAlgo();
  algorithm->Load(shape);
  algorithm->Projector(projector);
  algorithm->Update();
  HLRBRep_PolyHLRToShape lines;
  lines.Update(algorithm);
  take_lines(lines);
}

/// In the child: writes the time of each view as it is finished.
void draw_all(const SolidPart& part, std::span<const Camera> cameras, OccMethod method, int out) {
  const TopoDS_Shape shape = shape_of(part);
  if (method == OccMethod::polygonal) BRepMesh_IncrementalMesh(shape, kMesh_px / cameras[0].pixels_per_unit, false, 0.5, false);
  for (const Camera& camera : cameras) {
    const HLRAlgo_Projector projector(
        gp_Ax2(point(camera.eye), direction(camera.world_from_camera[2]), direction(camera.world_from_camera[0])));
    const auto start = std::chrono::steady_clock::now();
    method == OccMethod::exact ? draw_exact(shape, projector) : draw_polygonal(shape, projector);
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (write(out, &ms, sizeof ms) != static_cast<ssize_t>(sizeof ms)) return;
  }
}

}  // namespace

std::optional<std::string> occ_version() { return OCC_VERSION_COMPLETE; }

OccRun occ_lines(const SolidPart& part, std::span<const Camera> cameras, OccMethod method, double limit_s) {
  OccRun run;
  int ends[2];
  if (pipe(ends) != 0) return run;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    draw_all(part, cameras, method, ends[1]);
    _exit(0);
  }
  close(ends[1]);
  const auto stop = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit_s);
  while (child > 0 && run.ms.size() < cameras.size()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(stop - std::chrono::steady_clock::now()).count();
    pollfd waiting{ends[0], POLLIN, 0};
    double ms = 0.0;
    if (left <= 0 || poll(&waiting, 1, static_cast<int>(left)) <= 0 || read(ends[0], &ms, sizeof ms) != static_cast<ssize_t>(sizeof ms))
      break;
    run.ms.push_back(ms);
  }
  run.finished = run.ms.size() == cameras.size();
  if (child > 0) {
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
  }
  close(ends[0]);
  return run;
}

}  // namespace limn::bench

#else

namespace limn::bench {

std::optional<std::string> occ_version() { return {}; }
OccRun occ_lines(const SolidPart&, std::span<const Camera>, OccMethod, double) { return {}; }

}  // namespace limn::bench

#endif
