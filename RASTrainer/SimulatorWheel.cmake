# Finds the simulator's wheel of this version and its SHA-256: sets `simulator_wheel` to both files.
#
# `make extension` builds them beside the module. Where that was not done, as where Slicer builds its
# extensions, the wheel of a release is downloaded, if the two lines below name it; without either
# there is no package, as its module could never set the simulator up.
set(RASTrainer_SIMULATOR_WHEEL_URL "" CACHE STRING "Address of the released wheel of this version")
set(RASTrainer_SIMULATOR_WHEEL_SHA256 "" CACHE STRING "SHA-256 of the released wheel")

file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/Logic/rastrainer/__init__.py" version REGEX "^__version__ = ")
string(REGEX REPLACE "^__version__ = \"(.*)\"$" "\\1" version "${version}")
set(wheel_name "rastrainer-${version}-py3-none-any.whl")
set(wheel "${CMAKE_CURRENT_LIST_DIR}/Resources/RASTrainerSimulator/${wheel_name}")

if(NOT EXISTS "${wheel}")
  if(NOT RASTrainer_SIMULATOR_WHEEL_URL OR NOT RASTrainer_SIMULATOR_WHEEL_SHA256)
    message(FATAL_ERROR "The simulator's wheel ${wheel_name} is missing. Build it, in "
      "${RASTrainer_SOURCE_DIR}, by: make extension")
  endif()
  set(wheel "${CMAKE_CURRENT_BINARY_DIR}/${wheel_name}")
  file(DOWNLOAD "${RASTrainer_SIMULATOR_WHEEL_URL}" "${wheel}"
    EXPECTED_HASH SHA256=${RASTrainer_SIMULATOR_WHEEL_SHA256}
    )
  file(WRITE "${wheel}.sha256" "${RASTrainer_SIMULATOR_WHEEL_SHA256}  ${wheel_name}\n")
endif()

file(SHA256 "${wheel}" actual)
file(READ "${wheel}.sha256" noted)
if(NOT noted STREQUAL "${actual}  ${wheel_name}\n")
  message(FATAL_ERROR "${wheel} is not the file that ${wheel_name}.sha256 notes. "
    "Build both anew, in ${RASTrainer_SOURCE_DIR}, by: make extension")
endif()
set(simulator_wheel "${wheel}" "${wheel}.sha256")
