// The command `lightwell`: parses, runs one subcommand, and turns every way of failing into its documented exit code.
#include <cstdio>
#include <new>

#include "cli/command.h"
#include "cli/exit_codes.h"
#include "format/encode/reader.h"
#include "precompute/bake/bake.h"
#include "server/client/client.h"

namespace lightwell::cli {
namespace {

constexpr const char* kFooter = R"(A first walk through it:
  lightwell bake room.glb -o room.lwc            precompute the light transport of a scene
  lightwell info room.lwc                        what is in the container
  lightwell render room.lwc --camera cam.json -o room.png
  lightwell evaluate room.lwc --technique prm --evaluator cpu --component total -o e.exr
  lightwell reference room.glb --component total --lightmap-size 256 --samples 256 -o r.exr
  lightwell compare r.exr e.exr

Exit codes: 0 done, 1 an error of this program, 2 wrong usage, 3 the input was rejected, 4 the container is damaged or
too new, 5 the server could not be reached or the job failed, 130 interrupted.)";

int run(int argc, char** argv) {
  Console console;
  Interrupt interrupt;
  Session session{console, interrupt};
  CLI::App app("Lightwell precomputes the light transport of static scenes for games.", "lightwell");
  app.set_version_flag("--version", std::string("lightwell ") + bake::productVersion());
  app.footer(kFooter);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  for (const auto add : {addBake, addInfo, addVerify, addEvaluate, addEnvironmentQueries, addReference, addCompare, addRender, addReport, addStress,
                         addSubmit, addJobs, addWatch, addFetch, addCancel}) add(app, session);
  try {
    app.parse(argc, argv);
    return kDone;
  } catch (const CLI::Success& success) {  // --help, --version
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    console.error(error.what() + std::string("\nTry lightwell --help, or lightwell COMMAND --help."));
    return kUsage;
  } catch (const Cancelled&) {
    console.line("interrupted");
    return kInterrupted;
  } catch (const UsageError& error) {
    console.error(error.what());
    return kUsage;
  } catch (const InputError& error) {
    console.error(error.what());
    return kInputRejected;
  } catch (const format::ContainerError& error) {
    console.error(error.what());
    return kContainerBad;
  } catch (const server::ServiceError& error) {
    console.error(error.what());
    return kServerFailed;
  } catch (const std::bad_alloc&) {
    console.error("out of memory");
    return kBug;
  } catch (const std::exception& error) {
    console.error(std::string("this is an error of lightwell itself: ") + error.what());
    return kBug;
  }
}

}  // namespace
}  // namespace lightwell::cli

int main(int argc, char** argv) { return lightwell::cli::run(argc, argv); }
