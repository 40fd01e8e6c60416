# Parts that are built where their tools are. The choice to leave one out is not cached unless the user made it: tools
# that are installed later would change nothing.
macro(olx_optional_part name description tools)
  if(${tools})
    option(${name} "${description}" ON)
  elseif(NOT DEFINED ${name})
    set(${name} OFF)
  endif()
endmacro()
