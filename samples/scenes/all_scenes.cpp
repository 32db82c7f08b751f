#include "samples/scenes/sample_scene.h"

namespace lightwell::samples {

std::vector<SampleScene> makeAllScenes() {
  return {makeCornellBox(false),    makeCornellBox(true), makeMarbleChamber(),  makeCorridorDoor(),
          makeColonnadeCourtyard(), makeSkySpheres(),     makeSphereOnPlane(), makeWindowRoom()};
}

}  // namespace lightwell::samples
