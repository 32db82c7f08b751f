#include "samples/scenes/sample_scene.h"

namespace lightwell::samples {

std::vector<SampleScene> makeAllScenes() {
  return {makeCornellBox(false),   makeCornellBox(true), makeMarbleChamber(), makeCorridorDoor(),
          makeColonnadeCourtyard(), makeSkySpheres(),     makeWindowRoom()};
}

}  // namespace lightwell::samples
