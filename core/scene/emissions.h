// What points emit: programs are run for the points of one program together.
#pragma once

#include "base/short_list.h"
#include "shading/program.h"

namespace rayleaf {

class EmissionRuns {
  public:
    static constexpr size_t kMost = kMostPoints;

    /// The inputs of one more point, at most kMost, to be filled; what they point to, and the result, stay until `run`.
    ShadingInputs& add(const Program& program, Color& result) {
        Point& point = points_.add();
        point.program = &program;
        point.result = &result;
        return point.inputs;
    }
    void run() const;

  private:
    struct Point {
        const Program* program = nullptr;
        Color* result = nullptr;
        ShadingInputs inputs = {};
    };
    ShortList<Point, kMost> points_;
};

}  // namespace rayleaf
