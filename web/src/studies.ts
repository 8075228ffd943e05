// Entry of the page of studies.
import "./style.css";
import "./studies.css";
import { StudyPage } from "./studies/page";

void new StudyPage().start();
