#ifndef TRILOBE_CORE_SYSTEM_UTC_TIME_H_
#define TRILOBE_CORE_SYSTEM_UTC_TIME_H_

#include <string>

namespace trilobe {

// The time now, ISO 8601: "2024-03-01T12:00:00Z".
std::string UtcNow();

}  // namespace trilobe

#endif  // TRILOBE_CORE_SYSTEM_UTC_TIME_H_
