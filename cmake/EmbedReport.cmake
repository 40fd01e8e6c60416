# cmake -DFOLDER=cli/html -DOUTPUT=page.c -P EmbedReport.cmake: the report's page, style and script in it, as a C array.
file(READ ${FOLDER}/report.html page)
file(READ ${FOLDER}/report.css style)
file(READ ${FOLDER}/report.js script)
string(REPLACE "{{style}}" "${style}" page "${page}")
string(REPLACE "{{script}}" "${script}" page "${page}")
string(HEX "${page}" digits)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${digits}")
file(WRITE ${OUTPUT} "extern const char html_report_page[];\nconst char html_report_page[] = {${bytes}0};\n")
