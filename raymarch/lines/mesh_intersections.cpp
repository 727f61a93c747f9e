// Lines along which parts of a mesh go through each other, joined from the places where an edge of one meets a face of the other.

#include <algorithm>

#include "raymarch/lines/mesh_layers.h"

namespace limn {
namespace {

/// Which of the two parts face the eye.
using Facing = std::pair<bool, bool>;

class MeetingWalk {
 public:
  explicit MeetingWalk(const PartMeetings& meetings) : meetings_(meetings), taken_(meetings.places.size(), false) {}

  /// Places in a row from one on that was not taken yet.
  struct Row {
    std::vector<size_t> places{};
    std::vector<std::array<std::uint32_t, 2>> faces{};  ///< Of the step from each place to the next; of an open row one less.
    bool closed = false;
  };
  Row from(size_t start) {
    Row row;
    size_t before = taken_.size();
    for (size_t at = start;;) {
      taken_[at] = true;
      row.places.push_back(at);
      const auto& next = meetings_.next[at];
      const auto go = std::find_if(next.begin(), next.end(), [&](const NextMeeting& k) { return k.place != before && !taken_[k.place]; });
      if (go == next.end()) {
        const auto back = std::find_if(next.begin(), next.end(), [&](const NextMeeting& k) { return k.place == start; });
        row.closed = back != next.end() && row.places.size() > 2;
        if (row.closed) row.faces.push_back(back->faces);
        return row;
      }
      row.faces.push_back(go->faces);
      before = at;
      at = go->place;
    }
  }
  /// First those that begin at an end or where several meet.
  std::vector<Row> all() {
    std::vector<Row> rows;
    const auto add = [&](size_t i) {
      if (Row row = from(i); row.places.size() > 1) rows.push_back(std::move(row));
    };
    for (size_t i = 0; i < taken_.size(); ++i) {
      if (!taken_[i] && meetings_.next[i].size() != 2) add(i);
    }
    for (size_t i = 0; i < taken_.size(); ++i) {
      if (!taken_[i]) add(i);
    }
    return rows;
  }

 private:
  const PartMeetings& meetings_;
  std::vector<bool> taken_;
};

}  // namespace

CurveSample MeshLayers::sample_of(const PartMeeting& meeting) const {
  CurveSample sample;
  sample.p = meeting.p;
  sample.lift = view_vector(camera_, sample.p);
  const bool lower_higher = glm::dot(meeting.lower_normal, sample.lift) >= glm::dot(meeting.upper_normal, sample.lift);
  sample.high = lower_higher ? meeting.lower_normal : meeting.upper_normal;
  sample.low = lower_higher ? meeting.upper_normal : meeting.lower_normal;
  sample.line_class = class_of(meeting);
  sample.object = meeting.object;
  project_sample(camera_, sample);
  return sample;
}

std::vector<SurfaceCurve> MeshLayers::intersections() const {
  const PartMeetings& meetings = tree_->meetings();
  const auto facing = [&](const PartMeeting& meeting) {
    const glm::dvec3 v = view_vector(camera_, meeting.p);
    return Facing(glm::dot(meeting.lower_normal, v) > 0.0, glm::dot(meeting.upper_normal, v) > 0.0);
  };
  std::vector<SurfaceCurve> curves;
  for (const MeetingWalk::Row& row : MeetingWalk(meetings).all()) {
    SurfaceCurve curve;
    curve.closed = row.closed;
    for (size_t i = 0; i < row.places.size(); ++i) {
      const PartMeeting& meeting = meetings.places[row.places[i]];
      curve.samples.push_back(sample_of(meeting));
      // Past a contour of either part the line lies on its other sheet.
      if (i > 0) curve.samples.back().joint = facing(meeting) != facing(meetings.places[row.places[i - 1]]);
      if (!smooth_) curve.samples.back().faces = row.faces[std::min(i, row.faces.size() - 1)];
    }
    if (!smooth_) make_exact(curve);
    if (!smooth_) pierce_exactly(curve);
    curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace limn
