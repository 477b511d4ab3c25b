# tdpt_commit(folder out): the abbreviated commit of the git checkout in `folder`; "" if it is none, as in a tarball,
# even one unpacked within another checkout. A new commit reconfigures the build.
function(tdpt_commit folder out)
  set(${out} "" PARENT_SCOPE)
  find_program(TDPT_GIT git)
  mark_as_advanced(TDPT_GIT)
  if(NOT TDPT_GIT OR NOT EXISTS ${folder}/.git)  # a folder; in worktrees a file
    return()
  endif()
  execute_process(COMMAND ${TDPT_GIT} rev-parse --short=7 HEAD WORKING_DIRECTORY ${folder}
                  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)  # without a commit, or of another user
    return()
  endif()
  foreach(file HEAD logs/HEAD)  # git appends to the second whenever the first comes to mean another commit
    execute_process(COMMAND ${TDPT_GIT} rev-parse --git-path ${file} WORKING_DIRECTORY ${folder}
                    OUTPUT_VARIABLE path OUTPUT_STRIP_TRAILING_WHITESPACE)
    get_filename_component(path ${path} ABSOLUTE BASE_DIR ${folder})
    if(EXISTS ${path})
      set_property(DIRECTORY ${folder} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
    endif()
  endforeach()
  set(${out} "${commit}" PARENT_SCOPE)
endfunction()
