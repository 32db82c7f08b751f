#include "server/log.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

namespace lightwell::server {
namespace {

constexpr spdlog::level::level_enum kLevels[] = {spdlog::level::debug, spdlog::level::info, spdlog::level::warn, spdlog::level::err};

std::string asJson(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

bool isPlain(const std::string& text) { return !text.empty() && text.find_first_of(" \"=\\\n\t\r") == std::string::npos; }

}  // namespace

Log::Log(std::string_view level, bool as_json)
    : logger_(std::make_shared<spdlog::logger>("lightwelld", std::make_shared<spdlog::sinks::stderr_sink_mt>())), as_json_(as_json) {
  logger_->set_level(spdlog::level::from_str(std::string(level)));
  logger_->set_pattern(as_json ? R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l",%v})" : "%Y-%m-%d %H:%M:%S.%e %l %v");
  logger_->flush_on(spdlog::level::debug);
}

void Log::operator()(LogLevel level, std::string_view event, std::initializer_list<Field> fields) const {
  std::string line = as_json_ ? "\"event\":" + asJson(event) : std::string(event);
  for (const auto& [key, value] : fields)
    if (as_json_)
      line.append(",").append(asJson(key)).append(":").append(asJson(value));
    else
      line.append(" ").append(key).append("=").append(isPlain(value) ? value : asJson(value));
  logger_->log(kLevels[int(level)], "{}", line);
}

}  // namespace lightwell::server
