// lightwell_worker: started by lightwelld, one for each job. Not meant to be started by hand.
#include <cstdio>

#include "server/execution/worker.h"

int main(int argc, char**) {
  if (argc > 1) {
    std::fputs("lightwell_worker is started by lightwelld, one for each job\n", stderr);
    return 2;
  }
  return lightwell::server::runWorker();
}
