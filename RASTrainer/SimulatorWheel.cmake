# Finds the simulator's wheel of this version and its SHA-256: sets `simulator_wheel` to both files, and
# `wheel_assets` to the folder of its robot, scenarios and studies.
#
# `make extension` builds the wheel beside the module. Without it there is no package, as its module
# could never set the simulator up.
file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/Logic/rastrainer/__init__.py" version REGEX "^__version__ = ")
string(REGEX REPLACE "^__version__ = \"(.*)\"$" "\\1" version "${version}")
set(wheel_name "rastrainer-${version}-py3-none-any.whl")
set(wheel "${CMAKE_CURRENT_LIST_DIR}/Resources/RASTrainerSimulator/${wheel_name}")

if(NOT EXISTS "${wheel}")
  message(FATAL_ERROR "The simulator's wheel ${wheel_name} is missing. Build it, in "
    "${RASTrainer_SOURCE_DIR}, by: make extension")
endif()

file(SHA256 "${wheel}" actual)
file(READ "${wheel}.sha256" noted)
if(NOT noted STREQUAL "${actual}  ${wheel_name}\n")
  message(FATAL_ERROR "${wheel} is not the file that ${wheel_name}.sha256 notes. "
    "Build both anew, in ${RASTrainer_SOURCE_DIR}, by: make extension")
endif()
set(simulator_wheel "${wheel}" "${wheel}.sha256")

set(unpacked "${CMAKE_CURRENT_BINARY_DIR}/wheel")
file(ARCHIVE_EXTRACT INPUT "${wheel}" DESTINATION "${unpacked}" PATTERNS "rastrainer_simulator/assets/*")
set(wheel_assets "${unpacked}/rastrainer_simulator/assets")
